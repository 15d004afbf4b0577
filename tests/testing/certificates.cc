#include "tests/testing/certificates.h"

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <cstdint>

namespace graspdb::testing {

// Not in the unnamed namespace: Authority::Signer has them as members.
struct Free {
  void operator()(BIO* object) const { BIO_free_all(object); }
  void operator()(X509* object) const { X509_free(object); }
  void operator()(EVP_PKEY* object) const { EVP_PKEY_free(object); }
};
using Certificate = std::unique_ptr<X509, Free>;
using Key = std::unique_ptr<EVP_PKEY, Free>;

namespace {

constexpr long kHour = 3600;

Key NewKey() { return Key(EVP_EC_gen("P-256")); }

template <typename Write>
std::string Pem(Write write) {
  const std::unique_ptr<BIO, Free> out(BIO_new(BIO_s_mem()));
  write(out.get());
  char* text = nullptr;
  const long bytes = BIO_get_mem_data(out.get(), &text);
  return {text, static_cast<std::size_t>(bytes)};
}

std::string PemOf(X509* certificate) {
  return Pem([&](BIO* out) { PEM_write_bio_X509(out, certificate); });
}

void AddExtension(X509* certificate, int kind, const std::string& value) {
  X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, nullptr, kind, value.c_str());
  X509_add_ext(certificate, extension, -1);
  X509_EXTENSION_free(extension);
}

// Not signed yet.
Certificate NewCertificate(const std::string& common_name, EVP_PKEY* key, long seconds) {
  Certificate out(X509_new());
  X509_set_version(out.get(), X509_VERSION_3);
  std::uint32_t serial = 0;
  RAND_bytes(reinterpret_cast<unsigned char*>(&serial), sizeof(serial));
  ASN1_INTEGER_set(X509_get_serialNumber(out.get()), serial >> 1U);
  X509_gmtime_adj(X509_getm_notBefore(out.get()), std::min(0L, seconds) - kHour);
  X509_gmtime_adj(X509_getm_notAfter(out.get()), seconds);
  X509_NAME_add_entry_by_txt(X509_get_subject_name(out.get()), "CN", MBSTRING_UTF8,
                             reinterpret_cast<const unsigned char*>(common_name.c_str()), -1, -1,
                             0);
  X509_set_pubkey(out.get(), key);
  return out;
}

}  // namespace

struct Authority::Signer {
  Key key;
  Certificate certificate;
};

Authority::Authority(const std::string& name) : signer_(std::make_unique<Signer>()) {
  signer_->key = NewKey();
  signer_->certificate = NewCertificate(name, signer_->key.get(), kHour);
  X509* own = signer_->certificate.get();
  X509_set_issuer_name(own, X509_get_subject_name(own));
  AddExtension(own, NID_basic_constraints, "critical,CA:TRUE");
  X509_sign(own, signer_->key.get(), EVP_sha256());
  certificate_ = PemOf(own);
}

Authority::~Authority() = default;

KeyPair Authority::Issue(const std::string& common_name, const std::string& names,
                         long seconds) const {
  const Key key = NewKey();
  const Certificate certificate = NewCertificate(common_name, key.get(), seconds);
  X509_set_issuer_name(certificate.get(), X509_get_subject_name(signer_->certificate.get()));
  if (!names.empty()) AddExtension(certificate.get(), NID_subject_alt_name, names);
  X509_sign(certificate.get(), signer_->key.get(), EVP_sha256());
  return {PemOf(certificate.get()), Pem([&](BIO* out) {
            PEM_write_bio_PrivateKey(out, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
          })};
}

}  // namespace graspdb::testing
