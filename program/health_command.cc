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
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "program/settings_file.h"

namespace graspdb {
namespace {

// grpc.health.v1.HealthCheckResponse with the status SERVING; gRPC has no public header of it.
constexpr std::string_view kServing("\x08\x01", 2);

struct TlsFiles {
  std::string ca;
  std::string cert;
  std::string key;
};

// The file's text; "" for no file.
absl::StatusOr<std::string> Read(const std::string& path) {
  if (path.empty()) return "";
  std::ifstream file(path);
  std::string out(std::istreambuf_iterator<char>(file), {});
  if (!file || out.empty()) return absl::FailedPreconditionError("cannot read " + path);
  return out;
}

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> CredentialsFrom(const TlsFiles& files) {
  if (files.ca.empty()) return grpc::InsecureChannelCredentials();
  const auto ca = Read(files.ca);
  if (!ca.ok()) return ca.status();
  const auto cert = Read(files.cert);
  if (!cert.ok()) return cert.status();
  const auto key = Read(files.key);
  if (!key.ok()) return key.status();
  return grpc::SslCredentials(
      {.pem_root_certs = *ca, .pem_private_key = *key, .pem_cert_chain = *cert});
}

absl::Status Check(const std::string& address, const TlsFiles& files, absl::Duration timeout) {
  const auto credentials = CredentialsFrom(files);
  if (!credentials.ok()) return credentials.status();
  grpc::GenericStub stub(grpc::CreateChannel(address, *credentials));
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
  if (!status.ok()) return absl::UnavailableError(address + ": " + status.error_message());
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
