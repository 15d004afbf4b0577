// The identities of a server: its callers, their tokens and roles, and the file of --identities.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "graspdb/v1/identity.pb.h"
#include "program/tls/watched_files.h"
#include "server/access/file_state.h"

namespace graspdb::server {

inline constexpr std::size_t kTokenHashBytes = 32;

// A new token: "graspdb_" and 256 random bits of OpenSSL, in base64url. Empty if there is no
// randomness.
std::string NewToken();

// SHA-256 of a token. That is enough for 256 random bits: a slow hash, as for passwords, protects
// what can be guessed.
std::string HashToken(std::string_view token);

// Bytes of a file of identities. Read again at each change; twice as many would still be fast.
inline constexpr std::size_t kMaxIdentitiesBytes = std::size_t{1} << 20U;
// Each call compares its token with all.
inline constexpr std::size_t kMaxIdentities = 1024;
// Tokens, and certificates, of one identity.
inline constexpr int kMaxCredentials = 4;

// INVALID_ARGUMENT with the wrong field.
absl::Status CheckIdentity(const v1::Identity& identity);

// Immutable.
class Identities {
 public:
  // Parses the text of a file: a v1::Identity as JSON on each line. Empty lines and lines that
  // begin with # are skipped. INVALID_ARGUMENT with the line.
  static absl::StatusOr<Identities> Parse(std::string_view text);

  // The identity with a token of this hash (HashToken); null for none. Compares it with all hashes,
  // each in constant time.
  const v1::Identity* FindTokenHash(std::string_view sha256) const;

  // `name` as in v1::Identity.certificates. Null for an unknown one.
  const v1::Identity* FindCertificate(const std::string& name) const;

  std::size_t size() const { return identities_.size(); }

 private:
  struct Token {
    std::string sha256;
    std::size_t identity;
  };

  // `seen` has the names, tokens and certificates so far.
  absl::Status Add(v1::Identity identity, std::set<std::string>* seen);

  std::vector<v1::Identity> identities_;
  std::vector<Token> tokens_;
  std::map<std::string, std::size_t> certificates_;
};

// Reads the file again within two seconds after it changes. A file that cannot be read, has an
// error or no identity at all is logged and read each second, and the identities before it stay; it
// has a fault until then. Thread-safe.
class IdentitiesFile {
 public:
  // FAILED_PRECONDITION for a file that cannot be read, has an error, with the line, or no
  // identity.
  static absl::StatusOr<std::unique_ptr<IdentitiesFile>> Open(const std::string& path);

  std::shared_ptr<const Identities> Get() const;

  // Why the file cannot be used as it is now; absent while it can.
  std::optional<FileFault> fault() const { return state_.fault(); }

 private:
  explicit IdentitiesFile(const std::string& path);
  absl::Status Load();

  const std::string path_;
  FileState state_{"--identities"};
  mutable absl::Mutex mutex_;
  std::shared_ptr<const Identities> identities_ ABSL_GUARDED_BY(mutex_);
  WatchedFiles file_;  // last: its thread uses the others
};

}  // namespace graspdb::server
