// Encryption of the server's port: its files, its credentials, and the certificates of clients.
#pragma once

#include <grpcpp/security/server_credentials.h>
#include <grpcpp/security/tls_certificate_verifier.h>

#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "program/tls/watched_files.h"
#include "server/access/file_state.h"

namespace graspdb::server {

// A certificate in PEM format, "" for none, and those between it and the authority, leaf first.
struct PeerCertificate {
  std::string leaf;
  std::string chain;
};

// OK if the certificate is valid now, for a TLS client, and signed by an authority in the PEM file.
// UNAUTHENTICATED with its subject, serial number and the reason; FAILED_PRECONDITION if the file
// cannot be read.
absl::Status VerifyClientCertificate(const PeerCertificate& peer, const std::string& authorities);

// Verifies in the handshake. Reads the file of authorities each time: it may change. Thread-safe.
class ClientCertificateVerifier : public grpc::experimental::ExternalCertificateVerifier {
 public:
  // Called for each refused handshake, from any thread.
  using OnRefused = std::function<void(const absl::Status&)>;

  // With `is_required` a client without a certificate is refused.
  ClientCertificateVerifier(std::string authorities, bool is_required, OnRefused on_refused);

  bool Verify(grpc::experimental::TlsCustomVerificationCheckRequest* request,
              std::function<void(grpc::Status)> callback, grpc::Status* sync_status) override;
  void Cancel(grpc::experimental::TlsCustomVerificationCheckRequest* request) override;

 private:
  const std::string authorities_;
  const bool is_required_;
  const OnRefused on_refused_;
};

// PEM files; empty paths: none.
struct TlsFiles {
  std::string cert = {};  // certificate chain of the server; empty: no TLS
  std::string key = {};
  std::string client_ca = {};  // certificates of the authorities that sign those of clients
  bool require_client_cert = false;
};

// INVALID_ARGUMENT for flags that do not fit together, FAILED_PRECONDITION with the file that
// cannot be used.
absl::Status CheckTlsFiles(const TlsFiles& files);

// Credentials of these files, and of what WatchTlsFiles() reads later, for new connections.
// `on_refused` gets each client that is refused in the handshake, from any thread, with who and
// why. The errors of TlsFileSet::Refresh().
absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> MakeServerCredentials(
    const TlsFiles& files, std::function<void(const absl::Status&)> on_refused);

// Reads changed files again; those of before stay in use while the changed ones fail CheckTlsFiles.
// Logs which it is, and notes it in `state`, which must outlive the result. Null without TLS.
std::unique_ptr<WatchedFiles> WatchTlsFiles(const TlsFiles& files, FileState& state);

}  // namespace graspdb::server
