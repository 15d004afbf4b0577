#include "program/health_command.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/security/credentials.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/match.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "base/status_macros.h"
#include "program/connections/proxy.h"
#include "program/settings_file.h"
#include "program/tls/pem_files.h"

namespace graspdb {
namespace {

// grpc.health.v1.HealthCheckResponse with the status SERVING; gRPC has no public header of it.
constexpr std::string_view kServing("\x08\x01", 2);

struct TlsFiles {
  std::string ca;
  std::string cert;
  std::string key;
};

std::string TextOf(const std::string& path) {
  std::ifstream file(path);
  std::string out(std::istreambuf_iterator<char>(file), {});
  return out;
}

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> CredentialsFrom(const TlsFiles& files) {
  if (files.ca.empty()) return grpc::InsecureChannelCredentials();
  absl::Status status = CheckCertificates({"--ca", files.ca});
  if (!files.cert.empty()) {
    status.Update(CheckKeyPair({"--cert", files.cert}, {"--key", files.key}));
  }
  if (!status.ok()) return status;
  return grpc::SslCredentials({.pem_root_certs = TextOf(files.ca),
                               .pem_private_key = files.key.empty() ? "" : TextOf(files.key),
                               .pem_cert_chain = files.cert.empty() ? "" : TextOf(files.cert)});
}

// What gRPC's text of a failed connection means; the text itself if that is unknown.
std::string ReasonOf(const std::string& text, const TlsFiles& files) {
  const auto has = [&](const char* part) { return absl::StrContains(text, part); };
  if (has("wrong version number")) return "it does not use TLS; leave out --ca";
  if (has("certificate verify failed")) {
    return "its certificate has expired or is not signed by an authority of --ca " + files.ca;
  }
  if (has("not in peer certificate") || has("does not match SSL server name")) {
    return "its certificate is for other host names; give an address that its subjectAltName has "
           "(an "
           "address in CN alone does not count)";
  }
  if (!has("Socket closed")) return text;
  if (files.ca.empty()) return "it closed the connection; give --ca if it uses TLS";
  return files.cert.empty() ? "it needs a client certificate; give --cert and --key"
                            : "it does not accept --cert " + files.cert;
}

absl::Status Check(const std::string& address, const TlsFiles& files, absl::Duration timeout) {
  ASSIGN_OR_RETURN(const auto credentials, CredentialsFrom(files));
  grpc::ChannelArguments arguments;
  if (IsLocalTarget(address)) arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  grpc::GenericStub stub(grpc::CreateCustomChannel(address, credentials, arguments));
  grpc::ClientContext context;
  context.set_deadline(absl::ToChronoTime(absl::Now() + timeout));
  grpc::CompletionQueue queue;
  const grpc::ByteBuffer request(nullptr, 0);  // for all services
  const auto call =
      stub.PrepareUnaryCall(&context, "/grpc.health.v1.Health/Check", request, &queue);
  call->StartCall();
  grpc::ByteBuffer response;
  grpc::Status status;
  call->Finish(&response, &status, nullptr);
  void* tag = nullptr;
  bool is_done = false;
  queue.Next(&tag, &is_done);
  if (!status.ok()) {
    return absl::UnavailableError(address + ": " + ReasonOf(status.error_message(), files) +
                                  ProxyAdvice(address));
  }
  grpc::Slice bytes;
  if (!response.TrySingleSlice(&bytes).ok() ||
      kServing != std::string_view(reinterpret_cast<const char*>(bytes.begin()), bytes.size())) {
    return absl::UnavailableError(address + ": NOT_SERVING; its log has the reason");
  }
  return absl::OkStatus();
}

}  // namespace

int RunHealthCommand(const std::string& program, std::string address, int argc, char** argv) {
  CLI::App app("Checks the health of a running " + program + " (grpc.health.v1).",
               program + " health");
  app.footer("Exit status: 0 if it is SERVING, 1 if it is not or does not answer.");
  TlsFiles files;
  double timeout_s = 2;
  app.add_option("ADDRESS", address, "HOST:PORT")->capture_default_str();
  app.add_option("--timeout", timeout_s, "Seconds until it counts as down")
      ->check(CLI::Range(0.01, 60.0))
      ->capture_default_str();
  CLI::Option* const ca = app.add_option("--ca", files.ca, "PEM file of its authority; uses TLS");
  CLI::Option* const cert =
      app.add_option("--cert", files.cert, "PEM file of a certificate to show")->needs(ca);
  cert->needs(app.add_option("--key", files.key, "PEM file of its private key")->needs(cert));
  if (const std::optional<int> end = ParseArguments(app, argc, argv)) return *end;
  const absl::Status status = Check(address, files, absl::Seconds(timeout_s));
  if (!status.ok()) {
    std::fprintf(stderr, "%s: %s\n", program.c_str(), std::string(status.message()).c_str());
    return 1;
  }
  std::printf("SERVING\n");
  return 0;
}

}  // namespace graspdb
