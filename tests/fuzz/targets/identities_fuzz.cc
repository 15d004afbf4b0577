// The file of --identities.
#include <algorithm>
#include <cstdint>
#include <string>

#include "server/access/identities.h"
#include "tests/fuzz/bytes_target.h"
#include "tests/fuzz/requirement.h"

namespace graspdb::fuzz {
namespace {

void Read(std::string_view text) {
  const auto identities = server::Identities::Parse(text);
  if (!identities.ok()) {
    Require(identities.status().message().size() < 500, "errors are short");
    return;
  }
  const auto lines = static_cast<std::size_t>(std::ranges::count(text, '\n')) + 1;
  Require(identities->size() <= std::min(lines, server::kMaxIdentities), "one a line at most");
  // The seeds' identities.
  if (const auto* found = identities->FindTokenHash(server::HashToken("token"))) {
    Require(!found->name().empty() && !found->roles().empty(), "an identity has name and roles");
  }
  if (const auto* found = identities->FindCertificate("cn:press-3")) {
    Require(!found->name().empty() && !found->roles().empty(), "an identity has name and roles");
  }
}

}  // namespace
}  // namespace graspdb::fuzz

GRASPDB_FUZZ_BYTES(graspdb::fuzz::Read)
