// Checks of certificates and keys, so that errors name the file: those of a TLS handshake do not.
#pragma once

#include <string>
#include <tuple>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace graspdb {

// A file and the flag that names it.
struct PemFile {
  std::string flag = {};
  std::string path = {};
  friend bool operator<(const PemFile& a, const PemFile& b) {
    return std::tie(a.flag, a.path) < std::tie(b.flag, b.path);
  }
};

// FAILED_PRECONDITION unless the file has at least one certificate (PEM), e.g. of an authority, and
// no incomplete one, as a file has while it is written.
absl::Status CheckCertificates(const PemFile& file);

// FAILED_PRECONDITION unless `certificate` begins with a certificate that is valid now and has no
// incomplete one, and `key` has its private key, without a passphrase.
absl::Status CheckKeyPair(const PemFile& certificate, const PemFile& key);

// The texts (PEM) of the certificates, and of the key before its certificates, without other parts
// of the files. The errors of the checks above, but the dates of a pair are not checked.
absl::StatusOr<std::string> ReadCertificates(const PemFile& file);
absl::StatusOr<std::string> ReadKeyPair(const PemFile& certificate, const PemFile& key);

// When the first certificate of the file expires. FAILED_PRECONDITION if it cannot be read.
absl::StatusOr<absl::Time> CertificateEnd(const PemFile& file);

}  // namespace graspdb
