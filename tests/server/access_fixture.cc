#include "tests/server/access_fixture.h"

#include <google/protobuf/util/json_util.h>

#include <sstream>

#include "absl/time/clock.h"
#include "graspdb/v1/identity.pb.h"
#include "server/access/identities.h"

namespace graspdb::testing {

void AccessTest::SetUp() {
  options_.identities = (folder_.path() / "identities.jsonl").string();
  options_.audit_log = (folder_.path() / "audit.jsonl").string();
  token_ = Add("admin", {v1::ROLE_ADMIN});
  ServerTest::SetUp();
}

std::string AccessTest::Add(const std::string& name, const std::vector<v1::Role>& roles,
                            const std::string& cell) {
  std::string token = server::NewToken();
  v1::Identity identity;
  identity.set_name(name);
  identity.set_cell(cell);
  for (const v1::Role role : roles) identity.add_roles(role);
  identity.add_token_sha256(server::HashToken(token));
  EXPECT_TRUE(google::protobuf::util::MessageToJsonString(identity, &lines_[name]).ok());
  tokens_[name] = token;
  Write();
  // The absence of the role is an answer to a known caller, too.
  if (server_ != nullptr) {
    while (StatusAs(token).error_code() == grpc::StatusCode::UNAUTHENTICATED) {
      absl::SleepFor(absl::Milliseconds(20));
    }
  }
  return token;
}

void AccessTest::Remove(const std::string& name) {
  lines_.erase(name);
  Write();
  while (StatusAs(tokens_.at(name)).error_code() != grpc::StatusCode::UNAUTHENTICATED) {
    absl::SleepFor(absl::Milliseconds(20));
  }
}

void AccessTest::WriteIdentities(const std::string& text) const {
  folder_.Write("identities.jsonl", text);
}

grpc::Status AccessTest::StatusAs(std::string token) {
  std::swap(token_, token);
  grpc::Status out = Call(&Catalog::GetCatalogStatus, v1::GetCatalogStatusRequest());
  std::swap(token_, token);
  return out;
}

std::vector<v1::AuditRecord> AccessTest::Audited() const {
  std::vector<v1::AuditRecord> out;
  std::istringstream text(audit_text());
  for (std::string line; std::getline(text, line);) {
    EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(line, &out.emplace_back()).ok())
        << line;
  }
  return out;
}

void AccessTest::Write() const {
  std::string text = "# identities of a test\n\n";
  for (const auto& [name, line] : lines_) text += line + "\n";
  WriteIdentities(text);
}

}  // namespace graspdb::testing
