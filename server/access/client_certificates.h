// Verification of client certificates, so that refused ones are in the audit log: gRPC's own
// verification ends the handshake without a trace of whose certificate it was.
#pragma once

#include <grpcpp/security/tls_certificate_verifier.h>

#include <functional>
#include <string>

#include "absl/status/status.h"

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

}  // namespace graspdb::server
