// A server with identities and an audit log.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "graspdb/v1/audit.pb.h"
#include "graspdb/v1/authorization.pb.h"
#include "tests/server/server_fixture.h"

namespace graspdb::testing {

class AccessTest : public ServerTest {
 protected:
  // With the identity "admin", whose token is sent by default.
  void SetUp() override;

  // Adds an identity and waits until the server knows it; returns its token.
  std::string Add(const std::string& name, const std::vector<v1::Role>& roles,
                  const std::string& cell = "");
  // Removes it from the file, and waits until the server has read that.
  void Remove(const std::string& name);
  // Writes other identities, for which nothing waits.
  void WriteIdentities(const std::string& text) const;

  // Reads the status with the token.
  grpc::Status StatusAs(std::string token);

  std::string audit_text() const { return files::BytesOf(options_.audit_log); }
  std::vector<v1::AuditRecord> Audited() const;

 private:
  void Write() const;

  std::map<std::string, std::string> lines_;   // by name
  std::map<std::string, std::string> tokens_;  // by name
};

}  // namespace graspdb::testing
