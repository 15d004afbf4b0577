// The files of TLS, as gRPC gets them. gRPC 1.51 reads the files that it is given each second, and
// aborts the process on an empty certificate or key and on a folder; a pair that does not fit makes
// it refuse connections. So it gets copies in memory, of complete files that fit each other only.
#pragma once

#include <grpcpp/security/tls_certificate_provider.h>

#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "program/tls/memory_file.h"
#include "program/tls/pem_files.h"

namespace graspdb {

// Files with empty paths are not used; those of certificate and key belong together.
struct TlsPaths {
  PemFile certificate = {};  // and those between it and the authority
  PemFile key = {};
  PemFile authorities = {};
  friend bool operator<(const TlsPaths& a, const TlsPaths& b) {
    return std::tie(a.certificate, a.key, a.authorities) <
           std::tie(b.certificate, b.key, b.authorities);
  }
};

// Thread-safe.
class TlsFileSet {
 public:
  // The set of these files: one, until the process ends, since gRPC may read the copies after the
  // last connection. It takes two file descriptors.
  static TlsFileSet& Of(const TlsPaths& paths);
  TlsFileSet(const TlsFileSet&) = delete;
  TlsFileSet& operator=(const TlsFileSet&) = delete;

  // Reads the files; gRPC uses them within a second. If they cannot be used, those of before stay
  // in use: FAILED_PRECONDITION with the file, or RESOURCE_EXHAUSTED (see MemoryFile). Expired
  // certificates can be used.
  absl::Status Refresh() ABSL_LOCKS_EXCLUDED(mutex_);

  // Provides what Refresh() has read, and what it reads later; nothing before it succeeds.
  std::shared_ptr<grpc::experimental::CertificateProviderInterface> MakeProvider() const
      ABSL_LOCKS_EXCLUDED(mutex_);

  // Those that are not empty.
  std::vector<std::string> paths() const;

 private:
  explicit TlsFileSet(TlsPaths files);

  const TlsPaths files_;
  mutable absl::Mutex mutex_;
  // The key and its certificates in one file: gRPC reads it for the key and again for the
  // certificates, and tries again if the time of modification has changed between.
  MemoryFile pair_ ABSL_GUARDED_BY(mutex_);
  MemoryFile authorities_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb
