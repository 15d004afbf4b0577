// The identities of a server: its callers and their roles.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "graspdb/v1/identity.pb.h"

namespace graspdb::server {

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

}  // namespace graspdb::server
