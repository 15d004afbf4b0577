#include "program/pem_files.h"

#include <openssl/bio.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <cerrno>
#include <ctime>
#include <memory>
#include <system_error>

#include "absl/strings/str_cat.h"

namespace graspdb {
namespace {

template <auto kFree>
struct Freed {
  template <typename T>
  void operator()(T* object) const {
    kFree(object);
  }
};
using Bio = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;

absl::Status Failed(const PemFile& file, const std::string& description) {
  return absl::FailedPreconditionError(absl::StrCat(file.flag, " ", file.path, " ", description));
}

absl::StatusOr<Bio> OpenFile(const PemFile& file) {
  errno = 0;
  Bio out(BIO_new_file(file.path.c_str(), "r"));
  if (out == nullptr) {
    return Failed(file, absl::StrCat("cannot be read (", std::generic_category().message(errno),
                                     "); check the path and its permissions"));
  }
  return out;
}

absl::StatusOr<Certificate> FirstCertificate(const PemFile& file) {
  const absl::StatusOr<Bio> in = OpenFile(file);
  if (!in.ok()) return in.status();
  Certificate out(PEM_read_bio_X509(in->get(), nullptr, nullptr, nullptr));
  if (out == nullptr) return Failed(file, "has no certificate in PEM format");
  return out;
}

// Without a terminal, where OpenSSL would read a passphrase.
int NoPassphrase(char* /*buffer*/, int /*size*/, int /*writing*/, void* /*data*/) { return -1; }

absl::Time ToTime(const ASN1_TIME* time) {
  std::tm parts{};
  ASN1_TIME_to_tm(time, &parts);
  return absl::FromTM(parts, absl::UTCTimeZone());
}

std::string TimeText(const ASN1_TIME* time) {
  return absl::FormatTime("%Y-%m-%d %H:%M UTC", ToTime(time), absl::UTCTimeZone());
}

}  // namespace

absl::Status CheckCertificates(const PemFile& file) { return FirstCertificate(file).status(); }

absl::Status CheckKeyPair(const PemFile& certificate, const PemFile& key) {
  const absl::StatusOr<Certificate> first = FirstCertificate(certificate);
  if (!first.ok()) return first.status();
  const absl::StatusOr<Bio> in = OpenFile(key);
  if (!in.ok()) return in.status();
  const Key private_key(PEM_read_bio_PrivateKey(in->get(), nullptr, NoPassphrase, nullptr));
  if (private_key == nullptr) {
    return Failed(key, "has no private key in PEM format, or one with a passphrase");
  }
  if (X509_check_private_key(first->get(), private_key.get()) != 1) {
    return Failed(key, absl::StrCat("is not the key of ", certificate.flag, " ", certificate.path));
  }
  const ASN1_TIME* begin = X509_get0_notBefore(first->get());
  const ASN1_TIME* end = X509_get0_notAfter(first->get());
  if (X509_cmp_current_time(end) < 0) {
    return Failed(certificate, absl::StrCat("expired on ", TimeText(end), "; renew it"));
  }
  if (X509_cmp_current_time(begin) > 0) {
    return Failed(certificate, absl::StrCat("is not valid before ", TimeText(begin),
                                            "; check the clock of this machine"));
  }
  return absl::OkStatus();
}

absl::StatusOr<absl::Time> CertificateEnd(const PemFile& file) {
  const absl::StatusOr<Certificate> first = FirstCertificate(file);
  if (!first.ok()) return first.status();
  return ToTime(X509_get0_notAfter(first->get()));
}

}  // namespace graspdb
