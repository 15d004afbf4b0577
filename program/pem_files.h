// Checks of certificates and keys, so that errors name the file: those of a TLS handshake do not.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace graspdb {

// A file and the flag that names it.
struct PemFile {
  std::string flag;
  std::string path;
};

// FAILED_PRECONDITION unless the file has at least one certificate (PEM), e.g. of an authority.
absl::Status CheckCertificates(const PemFile& file);

// FAILED_PRECONDITION unless `certificate` begins with a certificate that is valid now, and `key`
// has its private key, without a passphrase.
absl::Status CheckKeyPair(const PemFile& certificate, const PemFile& key);

// When the first certificate of the file expires. FAILED_PRECONDITION if it cannot be read.
absl::StatusOr<absl::Time> CertificateEnd(const PemFile& file);

}  // namespace graspdb
