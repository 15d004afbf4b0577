#include "server/access/tls.h"

#include <grpcpp/security/tls_credentials_options.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509_vfy.h>
#include <openssl/x509v3.h>
#include <spdlog/spdlog.h>

#include <array>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/log/log_field.h"
#include "program/tls/pem_files.h"
#include "program/tls/tls_file_set.h"

namespace graspdb::server {
namespace {

// Certificates of a chain that are read; real ones have one to three.
constexpr int kMaxChain = 8;

// Bytes of a subject in an error; longer ones are cut.
constexpr int kMaxSubject = 256;

template <auto kFree>
struct OpenSslFree {
  template <typename T>
  void operator()(T* object) const {
    kFree(object);
  }
};
void FreeChain(STACK_OF(X509) * chain) { sk_X509_pop_free(chain, X509_free); }
using BioPtr = std::unique_ptr<BIO, OpenSslFree<BIO_free_all>>;
using X509Ptr = std::unique_ptr<X509, OpenSslFree<X509_free>>;
using StorePtr = std::unique_ptr<X509_STORE, OpenSslFree<X509_STORE_free>>;
using ContextPtr = std::unique_ptr<X509_STORE_CTX, OpenSslFree<X509_STORE_CTX_free>>;
using ChainPtr = std::unique_ptr<STACK_OF(X509), OpenSslFree<FreeChain>>;

X509Ptr NextCertificate(BIO* in) {
  X509Ptr out(PEM_read_bio_X509(in, nullptr, nullptr, nullptr));
  if (out == nullptr) ERR_clear_error();  // of the end of the text
  return out;
}

BioPtr TextOf(const std::string& pem) {
  return BioPtr(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
}

std::string Describe(X509* certificate) {
  std::array<char, kMaxSubject> subject{};
  X509_NAME_oneline(X509_get_subject_name(certificate), subject.data(), kMaxSubject);
  const std::unique_ptr<BIGNUM, OpenSslFree<BN_free>> number(
      ASN1_INTEGER_to_BN(X509_get0_serialNumber(certificate), nullptr));
  const std::unique_ptr<char, decltype([](char* text) { OPENSSL_free(text); })> serial(
      number == nullptr ? nullptr : BN_bn2hex(number.get()));
  return absl::StrCat("the client certificate ", subject.data(), ", serial number ",
                      serial == nullptr ? "unknown" : serial.get());
}

// ClientCertificateVerifier reads the file of authorities.
TlsFileSet& FileSetOf(const TlsFiles& files) {
  return TlsFileSet::Of(
      {.certificate = {"--tls-cert", files.cert}, .key = {"--tls-key", files.key}});
}

}  // namespace

absl::Status VerifyClientCertificate(const PeerCertificate& peer, const std::string& authorities) {
  const X509Ptr leaf = NextCertificate(TextOf(peer.leaf).get());
  if (leaf == nullptr) {
    return absl::UnauthenticatedError("the client has no certificate; give --cert and --key");
  }
  const ChainPtr chain(sk_X509_new_null());
  const BioPtr others = TextOf(peer.chain);
  for (int i = 0; i < kMaxChain; ++i) {
    X509Ptr next = NextCertificate(others.get());
    if (next == nullptr || sk_X509_push(chain.get(), next.get()) == 0) break;
    static_cast<void>(next.release());  // the chain's
  }
  const StorePtr store(X509_STORE_new());
  if (X509_STORE_load_file(store.get(), authorities.c_str()) != 1) {
    ERR_clear_error();
    return absl::FailedPreconditionError(
        absl::StrCat("no client can be verified: cannot read --tls-client-ca ", authorities));
  }
  const ContextPtr context(X509_STORE_CTX_new());
  if (context == nullptr ||
      X509_STORE_CTX_init(context.get(), store.get(), leaf.get(), chain.get()) != 1 ||
      X509_STORE_CTX_set_purpose(context.get(), X509_PURPOSE_SSL_CLIENT) != 1) {
    return absl::InternalError("OpenSSL cannot verify certificates");
  }
  if (X509_verify_cert(context.get()) == 1) return absl::OkStatus();
  ERR_clear_error();
  return absl::UnauthenticatedError(absl::StrCat(
      Describe(leaf.get()),
      ", was refused: ", X509_verify_cert_error_string(X509_STORE_CTX_get_error(context.get()))));
}

ClientCertificateVerifier::ClientCertificateVerifier(std::string authorities, bool is_required,
                                                     OnRefused on_refused)
    : authorities_(std::move(authorities)),
      is_required_(is_required),
      on_refused_(std::move(on_refused)) {}

bool ClientCertificateVerifier::Verify(
    grpc::experimental::TlsCustomVerificationCheckRequest* request,
    std::function<void(grpc::Status)> /*callback*/, grpc::Status* sync_status) {
  const auto text = [](const grpc::string_ref& value) {
    return std::string(value.data(), value.size());
  };
  const PeerCertificate peer = {text(request->peer_cert()), text(request->peer_cert_full_chain())};
  if (peer.leaf.empty() && !is_required_) return true;
  const absl::Status status = VerifyClientCertificate(peer, authorities_);
  if (!status.ok()) {
    *sync_status = grpc::Status(grpc::StatusCode::UNAUTHENTICATED, std::string(status.message()));
    on_refused_(status);
  }
  return true;  // *sync_status has the result
}

void ClientCertificateVerifier::Cancel(
    grpc::experimental::TlsCustomVerificationCheckRequest* /*request*/) {}

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
