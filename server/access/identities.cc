#include "server/access/identities.h"

#include <google/protobuf/util/json_util.h>
#include <openssl/crypto.h>
#include <openssl/rand.h>
#include <openssl/sha.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "base/status_macros.h"
#include "program/log/log_field.h"
#include "program/text/json_keys.h"
#include "program/text/text_encoding.h"
#include "storage/records/resource_name.h"

namespace graspdb::server {
namespace {

// Bytes of a certificate's name; a URI may have 2048, but none of those in use for workloads does.
constexpr std::size_t kMaxCertificateBytes = 256;

absl::Status CheckRoles(const v1::Identity& identity) {
  const auto is_role = [](int role) {
    return v1::Role_IsValid(role) && role != v1::ROLE_UNSPECIFIED;
  };
  if (identity.roles().empty())
    return absl::InvalidArgumentError("roles are missing; give at least one");
  if (!std::ranges::all_of(identity.roles(), is_role))
    return absl::InvalidArgumentError("has an unknown role");
  return absl::OkStatus();
}

absl::Status CheckCredentials(const v1::Identity& identity) {
  if (identity.token_sha256_size() > kMaxCredentials ||
      identity.certificates_size() > kMaxCredentials) {
    return absl::InvalidArgumentError(
        absl::StrCat("has more than ", kMaxCredentials, " tokens or certificates"));
  }
  for (const std::string& hash : identity.token_sha256()) {
    if (hash.size() != kTokenHashBytes)
      return absl::InvalidArgumentError("tokenSha256 is not 32 bytes in base64");
  }
  for (const std::string& name : identity.certificates()) {
    const bool is_typed = absl::StartsWith(name, "uri:") || absl::StartsWith(name, "dns:") ||
                          absl::StartsWith(name, "cn:");
    if (!is_typed || name.size() > kMaxCertificateBytes) {
      return absl::InvalidArgumentError(
          "a certificate's name is not uri:, dns: or cn: and a name of at most 256 bytes");
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<v1::Identity> ParseLine(absl::string_view line) {
  v1::Identity identity;
  const auto parsed = google::protobuf::util::JsonStringToMessage(std::string(line), &identity);
  if (!parsed.ok()) {
    // The parser quotes the text, which may have a token in the place of its hash.
    return absl::InvalidArgumentError(
        "is no identity in JSON; graspdb-server token NAME prints a correct line");
  }
  if (!CheckJsonKeys(line).ok()) {  // its error has the key, which may be a token in a wrong place
    return absl::InvalidArgumentError("has a key twice, whose values would be added; delete one");
  }
  RETURN_IF_ERROR(CheckIdentity(identity));
  return identity;
}

// At most one byte more than allowed, which the parser rejects.
absl::StatusOr<std::string> ReadBounded(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string out(kMaxIdentitiesBytes + 1, '\0');
  file.read(out.data(), static_cast<std::streamsize>(out.size()));
  if (!file.is_open() || file.bad()) {
    return absl::FailedPreconditionError(absl::StrCat("cannot read --identities ", path, " (",
                                                      std::strerror(errno),
                                                      "); check the path and its permissions"));
  }
  out.resize(static_cast<std::size_t>(file.gcount()));
  return out;
}

}  // namespace

std::string NewToken() {
  std::array<unsigned char, 32> bits;
  if (RAND_bytes(bits.data(), static_cast<int>(bits.size())) != 1) return "";
  return absl::StrCat("graspdb_", absl::WebSafeBase64Escape(absl::string_view(
                                      reinterpret_cast<const char*>(bits.data()), bits.size())));
}

std::string HashToken(std::string_view token) {
  std::string out(kTokenHashBytes, '\0');
  SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(),
         reinterpret_cast<unsigned char*>(out.data()));
  return out;
}

absl::Status CheckIdentity(const v1::Identity& identity) {
  if (absl::Status named = storage::ValidateResourceId(identity.name()); !named.ok()) {
    return absl::InvalidArgumentError(absl::StrCat("name: ", named.message()));
  }
  if (!identity.cell().empty()) {
    RETURN_IF_ERROR(storage::CheckCellName(identity.cell()));
  }
  RETURN_IF_ERROR(CheckRoles(identity));
  return CheckCredentials(identity);
}

absl::Status Identities::Add(v1::Identity identity, std::set<std::string>* seen) {
  const std::size_t index = identities_.size();
  if (index == kMaxIdentities) {
    return absl::InvalidArgumentError(
        absl::StrCat("is one more than the maximum of ", kMaxIdentities));
  }
  if (!seen->insert(absl::StrCat("name ", identity.name())).second) {
    return absl::InvalidArgumentError(
        absl::StrCat("identity ", identity.name(), " is given twice"));
  }
  for (const std::string& sha256 : identity.token_sha256()) {
    if (!seen->insert(absl::StrCat("token ", sha256)).second) {
      return absl::InvalidArgumentError("a token is given twice");
    }
    tokens_.push_back({sha256, index});
  }
  for (const std::string& name : identity.certificates()) {
    if (!certificates_.emplace(name, index).second)
      return absl::InvalidArgumentError("a certificate is given twice");
  }
  identities_.push_back(std::move(identity));
  return absl::OkStatus();
}

absl::StatusOr<Identities> Identities::Parse(std::string_view text) {
  if (text.size() > kMaxIdentitiesBytes)
    return absl::InvalidArgumentError("the file is longer than 1 MiB");
  Identities out;
  std::set<std::string> seen;
  int number = 0;
  for (absl::string_view line : absl::StrSplit(absl::string_view(text.data(), text.size()), '\n')) {
    ++number;
    line = absl::StripAsciiWhitespace(line);
    if (line.empty() || line.front() == '#') continue;
    absl::StatusOr<v1::Identity> identity = ParseLine(line);
    absl::Status added = identity.ok() ? out.Add(*std::move(identity), &seen) : identity.status();
    if (!added.ok())
      return absl::InvalidArgumentError(absl::StrCat("line ", number, ": ", added.message()));
  }
  return out;
}

const v1::Identity* Identities::FindTokenHash(std::string_view sha256) const {
  if (sha256.size() != kTokenHashBytes) return nullptr;
  const v1::Identity* out = nullptr;
  for (const Token& known : tokens_) {
    if (CRYPTO_memcmp(known.sha256.data(), sha256.data(), kTokenHashBytes) == 0) {
      out = &identities_[known.identity];
    }
  }
  return out;
}

const v1::Identity* Identities::FindCertificate(const std::string& name) const {
  const auto found = certificates_.find(name);
  return found == certificates_.end() ? nullptr : &identities_[found->second];
}

IdentitiesFile::IdentitiesFile(const std::string& path) : path_(path), file_({path}) {}

absl::StatusOr<std::unique_ptr<IdentitiesFile>> IdentitiesFile::Open(const std::string& path) {
  std::unique_ptr<IdentitiesFile> out(new IdentitiesFile(path));
  RETURN_IF_ERROR(out->Load());
  out->file_.Start([file = out.get(), last_error = std::string()]() mutable {
    const absl::Status status = file->Load();
    file->state_.Note(status);
    const std::string error(status.message());
    if (status.ok()) {
      spdlog::info("event=identities_read file={} count={}", LogField(file->path_),
                   file->Get()->size());
    } else if (error != last_error) {
      spdlog::error("event=identities_invalid error={}", LogField(error));
    }
    last_error = error;
    // A revocation must not be missed because no file could be opened at that moment.
    return status.ok();
  });
  return out;
}

std::shared_ptr<const Identities> IdentitiesFile::Get() const {
  absl::MutexLock lock(&mutex_);
  return identities_;
}

absl::Status IdentitiesFile::Load() {
  ASSIGN_OR_RETURN(std::string text, ReadBounded(path_));
  if (absl::Status taken = TakeUtf8(absl::StrCat("--identities ", path_), &text); !taken.ok()) {
    return absl::FailedPreconditionError(taken.message());
  }
  absl::StatusOr<Identities> parsed = Identities::Parse(text);
  if (!parsed.ok()) {
    return absl::FailedPreconditionError(
        absl::StrCat("--identities ", path_, ": ", parsed.status().message()));
  }
  // As of a file that was emptied, or is being written in place: every caller would be refused.
  if (parsed->size() == 0) {
    return absl::FailedPreconditionError(
        absl::StrCat("--identities ", path_,
                     " has no identity; graspdb-server token NAME prints a line for one"));
  }
  auto identities = std::make_shared<const Identities>(*std::move(parsed));
  absl::MutexLock lock(&mutex_);
  identities_ = std::move(identities);
  return absl::OkStatus();
}

}  // namespace graspdb::server
