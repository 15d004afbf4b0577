#include "server/access/identities.h"

#include <gmock/gmock.h>

#include <chrono>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "program/base/stop_flag.h"
#include "program/tls/watched_files.h"
#include "server/access/method_role.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::server {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

std::string HashText(const std::string& token) { return absl::Base64Escape(HashToken(token)); }

// An identity with the given further fields.
std::string Line(const std::string& name, const std::string& fields) {
  return absl::StrCat(R"({"name":")", name, R"(","roles":["ROLE_READ"])", fields, "}\n");
}

std::string NameOf(const v1::Identity* identity) {
  return identity == nullptr ? "" : identity->name();
}

void ExpectInvalid(const std::string& text, const std::string& words) {
  EXPECT_THAT(Identities::Parse(text),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(words)));
}

TEST(Identities, AreFoundByTokenAndCertificate) {
  const std::string text =
      "# a comment\n\n" +
      Line("a",
           absl::StrCat(R"(,"tokenSha256":[")", HashText("one"), "\",\"", HashText("two"), "\"]")) +
      Line("b", R"(,"certificates":["uri:spiffe://plant/b","cn:b"],"cell":"cells/b")");
  const auto identities = Identities::Parse(text);
  ASSERT_THAT(identities, IsOk());
  EXPECT_EQ(identities->size(), 2U);
  EXPECT_EQ(NameOf(identities->FindTokenHash(HashToken("one"))), "a");
  EXPECT_EQ(NameOf(identities->FindTokenHash(HashToken("two"))), "a");
  EXPECT_EQ(NameOf(identities->FindTokenHash(HashToken("three"))), "");
  EXPECT_EQ(NameOf(identities->FindTokenHash("")), "");
  EXPECT_EQ(NameOf(identities->FindCertificate("uri:spiffe://plant/b")), "b");
  EXPECT_EQ(NameOf(identities->FindCertificate("cn:b")), "b");
  EXPECT_EQ(NameOf(identities->FindCertificate("dns:b")), "");
}

TEST(Identities, WrongLinesAreNamed) {
  ExpectInvalid(Line("a", "") + "{\"name\":\n", "line 2: is no identity in JSON");
  ExpectInvalid(Line("a", R"(,"role":"ROLE_ADMIN")"), "line 1: is no identity in JSON");
  ExpectInvalid(Line("a", R"(,"roles":["ROLE_KING"])"), "is no identity in JSON");
  ExpectInvalid(R"({"name":"a","roles":[77]})", "unknown role");
  ExpectInvalid(Line("a", R"(,"roles":["ROLE_ADMIN"])"), "has a key twice");
  ExpectInvalid(R"({"name":"a"})", "roles are missing");
  ExpectInvalid(Line("a b", ""), "is not an id");
  ExpectInvalid(Line("a", R"(,"cell":"press-3")"), "cells/{cell}");
  ExpectInvalid(Line("a", R"(,"tokenSha256":["AAAA"])"), "32 bytes");
  ExpectInvalid(Line("a", R"(,"certificates":["press-3"])"), "uri:, dns: or cn:");
}

TEST(Identities, AmbiguousOnesAreRejected) {
  const std::string token = absl::StrCat(R"(,"tokenSha256":[")", HashText("one"), "\"]");
  ExpectInvalid(Line("a", "") + Line("a", ""), "line 2: identity a is given twice");
  ExpectInvalid(Line("a", token) + Line("b", token), "line 2: a token is given twice");
  ExpectInvalid(Line("a", R"(,"certificates":["cn:a"])") + Line("b", R"(,"certificates":["cn:a"])"),
                "line 2: a certificate is given twice");
}

TEST(Identities, AreLimited) {
  std::string text;
  for (std::size_t i = 0; i < kMaxIdentities; ++i) text += Line(absl::StrCat("a", i), "");
  EXPECT_THAT(Identities::Parse(text), IsOk());
  ExpectInvalid(text + Line("b", ""), "maximum of 1024");
  ExpectInvalid(std::string(kMaxIdentitiesBytes + 1, '\n'), "1 MiB");
  ExpectInvalid(Line("a", R"(,"certificates":["cn:1","cn:2","cn:3","cn:4","cn:5"])"),
                "more than 4");
}

TEST(Identities, ATokenInThePlaceOfItsHashIsNotRepeatedInTheError) {
  const std::string token = NewToken();
  const auto parsed = Identities::Parse(Line("a", R"(,"tokenSha256":[")" + token + "!\"]"));
  EXPECT_THAT(parsed,
              StatusIs(absl::StatusCode::kInvalidArgument, ::testing::Not(HasSubstr(token))));
}

TEST(IdentitiesFile, AMissingOneIsAnErrorWithAdvice) {
  EXPECT_THAT(IdentitiesFile::Open("/nonexistent/identities.jsonl").status(),
              StatusIs(absl::StatusCode::kFailedPrecondition,
                       ::testing::EndsWith(
                           "(No such file or directory); check the path and its permissions")));
}

TEST(WatchedFiles, AFileThatCouldNotBeUsedIsTriedAgain) {
  const files::TemporaryFolder folder;
  StopFlag tried_again;
  int tries = 0;
  WatchedFiles files({folder.Write("identities.jsonl", "").string()});
  files.Start([&] {
    if (++tries == 2) tried_again.Raise();
    return tries >= 2;
  });
  folder.Write("identities.jsonl", "# changed once\n");
  EXPECT_TRUE(tried_again.Wait(std::chrono::minutes(1)));
}

TEST(Tokens, AreLongAndDifferent) {
  EXPECT_THAT(NewToken(), ::testing::MatchesRegex("graspdb_[A-Za-z0-9_-]{43}"));
  EXPECT_NE(NewToken(), NewToken());
}

}  // namespace
}  // namespace graspdb::server
