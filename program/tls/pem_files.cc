#include "program/tls/pem_files.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <ctime>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/text/text_encoding.h"

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

// That fit each other.
struct KeyPair {
  std::vector<Certificate> chain;  // that of the key first
  Key key;
};

absl::Status Failed(const PemFile& file, const std::string& description) {
  return absl::FailedPreconditionError(absl::StrCat(file.flag, " ", file.path, " ", description));
}

absl::StatusOr<Bio> OpenFile(const PemFile& file) {
  std::error_code ignored;
  const std::filesystem::file_status kind = std::filesystem::status(file.path, ignored);
  // To open a pipe would wait for its writer.
  if (std::filesystem::exists(kind) && !std::filesystem::is_regular_file(kind)) {
    return Failed(file, "is not a regular file; give one in PEM format");
  }
  errno = 0;
  Bio out(BIO_new_file(file.path.c_str(), "r"));
  if (out == nullptr) {
    return Failed(file, absl::StrCat("cannot be read (", std::generic_category().message(errno),
                                     "); check the path and its permissions"));
  }
  // Of editors of Windows; OpenSSL would skip the first block with it.
  std::array<char, kByteOrderMark.size()> start{};
  const int read = BIO_read(out.get(), start.data(), static_cast<int>(start.size()));
  if (absl::string_view(start.data(), static_cast<std::size_t>(std::max(read, 0))) !=
      kByteOrderMark) {
    BIO_seek(out.get(), 0);
  }
  return out;
}

// At least one; other blocks of the file, such as a key, are skipped.
absl::StatusOr<std::vector<Certificate>> CertificatesOf(const PemFile& file) {
  ASSIGN_OR_RETURN(const Bio in, OpenFile(file));
  ERR_clear_error();
  std::vector<Certificate> out;
  while (X509* next = PEM_read_bio_X509(in.get(), nullptr, nullptr, nullptr)) {
    out.emplace_back(next);
  }
  const bool is_end = ERR_GET_REASON(ERR_peek_last_error()) == PEM_R_NO_START_LINE;
  ERR_clear_error();
  if (!is_end) return Failed(file, "has an incomplete or damaged part");
  if (out.empty()) return Failed(file, "has no certificate in PEM format");
  return out;
}

// Without a terminal, where OpenSSL would read a passphrase.
int NoPassphrase(char* /*buffer*/, int /*size*/, int /*writing*/, void* /*data*/) { return -1; }

absl::StatusOr<KeyPair> KeyPairOf(const PemFile& certificate, const PemFile& key) {
  ASSIGN_OR_RETURN(std::vector<Certificate> chain, CertificatesOf(certificate));
  ASSIGN_OR_RETURN(const Bio in, OpenFile(key));
  Key private_key(PEM_read_bio_PrivateKey(in.get(), nullptr, NoPassphrase, nullptr));
  ERR_clear_error();
  if (private_key == nullptr) {
    return Failed(key, "has no private key in PEM format, or one with a passphrase");
  }
  const bool is_fitting = X509_check_private_key(chain.front().get(), private_key.get()) == 1;
  ERR_clear_error();
  if (!is_fitting) {
    return Failed(key, absl::StrCat("is not the key of ", certificate.flag, " ", certificate.path));
  }
  return KeyPair{std::move(chain), std::move(private_key)};
}

// The key, unless it is null, and the certificates.
absl::StatusOr<std::string> PemText(EVP_PKEY* key, const std::vector<Certificate>& certificates) {
  const Bio out(BIO_new(BIO_s_mem()));
  bool is_written = out != nullptr &&
                    (key == nullptr || PEM_write_bio_PrivateKey(out.get(), key, nullptr, nullptr, 0,
                                                                nullptr, nullptr) == 1);
  for (const Certificate& certificate : certificates) {
    is_written = is_written && PEM_write_bio_X509(out.get(), certificate.get()) == 1;
  }
  char* text = nullptr;
  const long size = is_written ? BIO_get_mem_data(out.get(), &text) : 0;
  if (size <= 0) return absl::InternalError("OpenSSL cannot write a certificate or key");
  return std::string(text, static_cast<std::size_t>(size));
}

absl::Time ToTime(const ASN1_TIME* time) {
  std::tm parts{};
  ASN1_TIME_to_tm(time, &parts);
  return absl::FromTM(parts, absl::UTCTimeZone());
}

std::string TimeText(const ASN1_TIME* time) {
  return absl::FormatTime("%Y-%m-%d %H:%M UTC", ToTime(time), absl::UTCTimeZone());
}

}  // namespace

absl::Status CheckCertificates(const PemFile& file) { return CertificatesOf(file).status(); }

absl::Status CheckKeyPair(const PemFile& certificate, const PemFile& key) {
  ASSIGN_OR_RETURN(const KeyPair pair, KeyPairOf(certificate, key));
  const ASN1_TIME* begin = X509_get0_notBefore(pair.chain.front().get());
  const ASN1_TIME* end = X509_get0_notAfter(pair.chain.front().get());
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
  ASSIGN_OR_RETURN(const std::vector<Certificate> certificates, CertificatesOf(file));
  return ToTime(X509_get0_notAfter(certificates.front().get()));
}

absl::StatusOr<std::string> ReadCertificates(const PemFile& file) {
  ASSIGN_OR_RETURN(const std::vector<Certificate> certificates, CertificatesOf(file));
  return PemText(nullptr, certificates);
}

absl::StatusOr<std::string> ReadKeyPair(const PemFile& certificate, const PemFile& key) {
  ASSIGN_OR_RETURN(const KeyPair pair, KeyPairOf(certificate, key));
  return PemText(pair.key.get(), pair.chain);
}

}  // namespace graspdb
