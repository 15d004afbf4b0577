#include "client/sdk/security.h"

#include <grpcpp/security/tls_credentials_options.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/ascii.h"
#include "absl/strings/cord.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/connections/loopback.h"
#include "program/connections/proxy.h"
#include "program/text/text_encoding.h"
#include "program/tls/tls_file_set.h"

namespace graspdb::client {
namespace {

using grpc::experimental::InterceptionHookPoints;

// Bytes of a token; those of the server have 51. Metadata may have 8 KiB in total.
constexpr std::size_t kMaxTokenBytes = 1024;

bool UsesTls(const SecurityOptions& options) {
  return !options.ca.empty() || !options.cert.empty() || !options.key.empty();
}

TlsFileSet& FilesOf(const SecurityOptions& options) {
  return TlsFileSet::Of({.certificate = {"--cert", options.cert},
                         .key = {"--key", options.key},
                         .authorities = {"--ca", options.ca}});
}

bool IsTokenSafe(const ConnectionOptions& options) {
  const std::string_view server = options.server;
  return UsesTls(options.security) || IsLoopback(server.substr(0, server.rfind(':')));
}

// Whether gRPC finds a port in it: without one it takes 443, or 0. Addresses with a resolver's name
// are left to gRPC.
bool IsServerAddress(const std::string& server) {
  if (server.starts_with("unix:") || server.starts_with("unix-abstract:") ||
      absl::StrContains(server, ":///")) {
    return true;
  }
  const std::size_t colon = server.rfind(':');
  if (colon == std::string::npos || absl::StrContains(server, "://")) return false;
  const std::string host = server.substr(0, colon);
  // An IPv6 address without brackets, whose last part is no port.
  const bool is_cut =
      host.ends_with(':') || (!host.ends_with(']') && std::ranges::count(host, ':') > 1);
  int port = 0;
  return !host.empty() && !is_cut && absl::SimpleAtoi(server.substr(colon + 1), &port) &&
         port > 0 && port <= 65535;
}

// A file that is missing, or that does not fit yet, may be right later: it is read again.
absl::Status CheckPemFile(const char* flag, const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status file = std::filesystem::status(path, error);
  if (path.empty() || !std::filesystem::exists(file)) return absl::OkStatus();
  if (!std::filesystem::is_regular_file(file)) {
    return absl::FailedPreconditionError(
        absl::StrCat(flag, " ", path, " is not a regular file; give one in PEM format"));
  }
  if (std::filesystem::file_size(path, error) != 0) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat(flag, " ", path, " is empty; give a file in PEM format"));
}

absl::StatusOr<std::string> ReadToken(const std::string& path) {
  std::string out;
  errno = 0;
  std::ifstream file(path);
  if (!std::getline(file, out) && errno != 0) {
    return absl::FailedPreconditionError(absl::StrCat(
        "cannot read --token-file ", path, " (", std::generic_category().message(errno),
        "); give a file of `graspdb-server token --out`, or leave it out"));
  }
  if (absl::Status taken = TakeUtf8(absl::StrCat("--token-file ", path), &out); !taken.ok()) {
    return absl::FailedPreconditionError(taken.message());
  }
  absl::StripAsciiWhitespace(&out);
  if (out.empty() || out.size() > kMaxTokenBytes ||
      !std::ranges::all_of(out, absl::ascii_isgraph)) {
    return absl::FailedPreconditionError(
        absl::StrCat("--token-file ", path, " has no token in its first line"));
  }
  return out;
}

class TokenInterceptor : public grpc::experimental::Interceptor {
 public:
  explicit TokenInterceptor(const std::string& path) : path_(path) {}

  void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override {
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_INITIAL_METADATA)) {
      // Without it the server answers UNAUTHENTICATED, which Explain() replaces by the reason.
      if (const absl::StatusOr<std::string> token = ReadToken(path_); token.ok()) {
        methods->GetSendInitialMetadata()->emplace("authorization",
                                                   absl::StrCat("Bearer ", *token));
      }
    }
    methods->Proceed();
  }

 private:
  const std::string& path_;
};

class TokenInterceptors : public grpc::experimental::ClientInterceptorFactoryInterface {
 public:
  explicit TokenInterceptors(std::string path) : path_(std::move(path)) {}

  grpc::experimental::Interceptor* CreateClientInterceptor(
      grpc::experimental::ClientRpcInfo* /*call*/) override {
    return new TokenInterceptor(path_);
  }

 private:
  const std::string path_;
};

// gRPC's text, with UNAUTHENTICATED, where the certificate has the address in CN alone.
constexpr char kOtherHost[] = "does not match SSL server name";

// What gRPC's text of a failed connection means; empty for another text.
std::string HandshakeAdvice(const std::string& text, const SecurityOptions& options) {
  const auto has = [&](const char* part) { return absl::StrContains(text, part); };
  if (has("certificate verify failed")) {
    return absl::StrCat("its certificate has expired or is not signed by an authority of ",
                        options.ca.empty() ? "the system; give --ca" : "--ca " + options.ca);
  }
  if (has("Hostname Verification") || has(kOtherHost)) {
    return "its certificate is for other host names; give --server with a name or address that its "
           "subjectAltName has (an address in CN alone does not count)";
  }
  if (has("wrong version number")) return "it does not use TLS; leave out --ca, --cert and --key";
  if (has("security handshaker")) return "the files of --ca, --cert and --key cannot be used";
  if (!has("failed to connect") || !has("Socket closed")) return "";
  if (!UsesTls(options))
    return "it closed the connection; give --ca if it uses TLS, or close others if it has too many "
           "(event=connections_refused in its log)";
  return options.cert.empty() ? "it needs a client certificate; give --cert and --key"
                              : "it does not accept --cert " + options.cert +
                                    ", which has expired or is signed by another authority";
}

absl::Status NoServer(const std::string& text, const ConnectionOptions& options) {
  const std::string advice = HandshakeAdvice(text, options.security);
  return absl::UnavailableError(
      advice.empty()
          ? absl::StrCat("no graspdb server is reachable at ", options.server,
                         "; start graspdb-server or give --server HOST:PORT (", text, ")",
                         ProxyAdvice(options.server))
          : absl::StrCat("cannot connect to the server at ", options.server, ": ", advice));
}

}  // namespace

absl::Status CheckUsage(const ConnectionOptions& options) {
  if (options.security.cert.empty() != options.security.key.empty()) {
    return absl::InvalidArgumentError("--cert and --key belong together; give both");
  }
  if (!IsServerAddress(options.server)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--server ", options.server.empty() ? "\"\"" : options.server,
                     " is not HOST:PORT; give one such as 127.0.0.1:50051"));
  }
  return absl::OkStatus();
}

absl::Status CheckOptions(const ConnectionOptions& options) {
  RETURN_IF_ERROR(CheckUsage(options));
  RETURN_IF_ERROR(CheckPemFile("--ca", options.security.ca));
  RETURN_IF_ERROR(CheckPemFile("--cert", options.security.cert));
  return CheckPemFile("--key", options.security.key);
}

absl::Status CheckToken(const ConnectionOptions& options) {
  const std::string& token_file = options.security.token_file;
  return token_file.empty() ? absl::OkStatus() : ReadToken(token_file).status();
}

std::shared_ptr<grpc::ChannelCredentials> MakeCredentials(const SecurityOptions& options) {
  if (!UsesTls(options)) return grpc::InsecureChannelCredentials();
  grpc::experimental::TlsChannelCredentialsOptions tls;
  TlsFileSet& files = FilesOf(options);
  files.Refresh().IgnoreError();  // a handshake without the files fails, see HandshakeAdvice()
  tls.set_certificate_provider(files.MakeProvider());
  if (!options.ca.empty()) tls.watch_root_certs();
  if (!options.cert.empty()) tls.watch_identity_key_cert_pairs();
  return grpc::experimental::TlsCredentials(tls);
}

std::unique_ptr<WatchedFiles> WatchTlsFiles(const SecurityOptions& options) {
  if (!UsesTls(options)) return nullptr;
  TlsFileSet& files = FilesOf(options);
  auto out = std::make_unique<WatchedFiles>(files.paths());
  out->Start([&files] { return files.Refresh().ok(); });
  return out;
}

std::vector<std::unique_ptr<grpc::experimental::ClientInterceptorFactoryInterface>>
MakeTokenInterceptors(const ConnectionOptions& options) {
  std::vector<std::unique_ptr<grpc::experimental::ClientInterceptorFactoryInterface>> out;
  if (!options.security.token_file.empty() && IsTokenSafe(options)) {
    out.push_back(std::make_unique<TokenInterceptors>(options.security.token_file));
  }
  return out;
}

absl::Status Explain(const grpc::Status& status, const ConnectionOptions& options) {
  if (status.ok()) return absl::OkStatus();
  // gRPC's own UNAVAILABLE describes sockets and has no details; the server's always has some.
  if (status.error_details().empty() && (status.error_code() == grpc::StatusCode::UNAVAILABLE ||
                                         absl::StrContains(status.error_message(), kOtherHost))) {
    return NoServer(status.error_message(), options);
  }
  const std::string& token_file = options.security.token_file;
  if (status.error_code() == grpc::StatusCode::UNAUTHENTICATED && !token_file.empty()) {
    RETURN_IF_ERROR(ReadToken(token_file).status());
    if (!IsTokenSafe(options)) {
      return absl::UnauthenticatedError(absl::StrCat("the token of --token-file ", token_file,
                                                     " is not sent to ", options.server,
                                                     " without encryption; give --ca"));
    }
  }
  absl::Status out(static_cast<absl::StatusCode>(status.error_code()), status.error_message());
  if (!status.error_details().empty()) {
    out.SetPayload(kErrorDetails, absl::Cord(status.error_details()));
  }
  return out;
}

}  // namespace graspdb::client
