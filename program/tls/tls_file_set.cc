#include "program/tls/tls_file_set.h"

#include <map>
#include <utility>

#include "absl/status/statusor.h"

namespace graspdb {
namespace {

// Seconds between gRPC's reads of the copies. Longer, and a renewed certificate is used later.
constexpr unsigned kProviderSeconds = 1;

}  // namespace

TlsFileSet::TlsFileSet(TlsPaths files) : files_(std::move(files)) {}

TlsFileSet& TlsFileSet::Of(const TlsPaths& paths) {
  static absl::Mutex mutex(absl::kConstInit);
  const absl::MutexLock lock(&mutex);
  static auto& sets = *new std::map<TlsPaths, std::unique_ptr<TlsFileSet>>;  // never destroyed
  std::unique_ptr<TlsFileSet>& out = sets[paths];
  if (out == nullptr) out.reset(new TlsFileSet(paths));
  return *out;
}

absl::Status TlsFileSet::Refresh() {
  const absl::MutexLock lock(&mutex_);
  const bool has_pair = !files_.certificate.path.empty();
  const bool has_authorities = !files_.authorities.path.empty();
  absl::StatusOr<std::string> pair = "";
  if (has_pair) pair = ReadKeyPair(files_.certificate, files_.key);
  if (!pair.ok()) return pair.status();
  absl::StatusOr<std::string> authorities = "";
  if (has_authorities) authorities = ReadCertificates(files_.authorities);
  if (!authorities.ok()) return authorities.status();
  absl::Status status;
  if (has_pair) status = pair_.Replace(*pair);
  if (has_authorities) status.Update(authorities_.Replace(*authorities));
  return status;
}

std::shared_ptr<grpc::experimental::CertificateProviderInterface> TlsFileSet::MakeProvider() const {
  const absl::MutexLock lock(&mutex_);
  const std::string pair = files_.certificate.path.empty() ? "" : pair_.path();
  const std::string authorities = files_.authorities.path.empty() ? "" : authorities_.path();
  return std::make_shared<grpc::experimental::FileWatcherCertificateProvider>(
      pair, pair, authorities, kProviderSeconds);
}

std::vector<std::string> TlsFileSet::paths() const {
  std::vector<std::string> out;
  for (const PemFile& file : {files_.certificate, files_.key, files_.authorities}) {
    if (!file.path.empty()) out.push_back(file.path);
  }
  return out;
}

}  // namespace graspdb
