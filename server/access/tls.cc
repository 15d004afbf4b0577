#include "server/access/tls.h"

#include <grpcpp/security/tls_credentials_options.h>
#include <spdlog/spdlog.h>

#include <string>
#include <utility>
#include <vector>

#include "base/status_macros.h"
#include "program/log/log_field.h"
#include "program/tls/pem_files.h"
#include "program/tls/tls_file_set.h"
#include "server/access/client_certificates.h"

namespace graspdb::server {
namespace {

// ClientCertificateVerifier reads the file of authorities.
TlsFileSet& FileSetOf(const TlsFiles& files) {
  return TlsFileSet::Of(
      {.certificate = {"--tls-cert", files.cert}, .key = {"--tls-key", files.key}});
}

}  // namespace

absl::Status CheckTlsFiles(const TlsFiles& files) {
  if (files.cert.empty() != files.key.empty()) {
    return absl::InvalidArgumentError("--tls-cert and --tls-key belong together; give both");
  }
  if (files.cert.empty() && !files.client_ca.empty()) {
    return absl::InvalidArgumentError("--tls-client-ca needs --tls-cert and --tls-key");
  }
  if (files.client_ca.empty() && files.require_client_cert) {
    return absl::InvalidArgumentError("--require-client-cert needs --tls-client-ca");
  }
  absl::Status status;
  if (!files.cert.empty()) {
    status = CheckKeyPair({"--tls-cert", files.cert}, {"--tls-key", files.key});
  }
  if (!files.client_ca.empty())
    status.Update(CheckCertificates({"--tls-client-ca", files.client_ca}));
  return status;
}

absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> MakeServerCredentials(
    const TlsFiles& files, std::function<void(const absl::Status&)> on_refused) {
  if (files.cert.empty()) return grpc::InsecureServerCredentials();
  TlsFileSet& set = FileSetOf(files);
  RETURN_IF_ERROR(set.Refresh());
  grpc::experimental::TlsServerCredentialsOptions options(set.MakeProvider());
  options.watch_identity_key_cert_pairs();
  if (!files.client_ca.empty()) {
    // The verifier does what gRPC's AND_VERIFY does, and reports whom it refuses.
    options.set_cert_request_type(GRPC_SSL_REQUEST_CLIENT_CERTIFICATE_BUT_DONT_VERIFY);
    options.set_certificate_verifier(
        grpc::experimental::ExternalCertificateVerifier::Create<ClientCertificateVerifier>(
            files.client_ca, files.require_client_cert, std::move(on_refused)));
  }
  return grpc::experimental::TlsServerCredentials(options);
}

std::unique_ptr<WatchedFiles> WatchTlsFiles(const TlsFiles& files, FileState& state) {
  if (files.cert.empty()) return nullptr;
  std::vector<std::string> paths = {files.cert, files.key};
  if (!files.client_ca.empty()) paths.push_back(files.client_ca);
  auto out = std::make_unique<WatchedFiles>(std::move(paths));
  out->Start([files, &state, last_error = std::string()]() mutable {
    absl::Status status = CheckTlsFiles(files);
    if (status.ok()) status = FileSetOf(files).Refresh();
    state.Note(status);
    const std::string error(status.message());
    if (status.ok()) {
      spdlog::info("event=tls_files_changed cert={}", LogField(files.cert));
    } else if (error != last_error) {
      spdlog::error("event=tls_files_invalid error={}", LogField(error));
    }
    last_error = error;
    // A certificate that is not valid yet becomes valid without a change of its file.
    return status.ok();
  });
  return out;
}

}  // namespace graspdb::server
