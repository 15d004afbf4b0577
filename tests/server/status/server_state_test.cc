// CatalogStatus.server_state: clock, index, disk and files of a server.
#include <gmock/gmock.h>

#include <cstdint>
#include <cstdlib>
#include <string>
#include <utility>

#include "absl/time/clock.h"
#include "tests/server/access_fixture.h"
#include "tests/testing/certificates.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

using ::testing::HasSubstr;

// Of 20 ms: a minute.
constexpr int kMaxPolls = 3000;

class ServerStateTest : public AccessTest {
 protected:
  v1::ServerState State() { return Status().server_state(); }

  // Waits until a file cannot be used for a reason with these words: a half-written one has others.
  v1::FileFault AwaitFault(const std::string& words) {
    for (int i = 0; i < kMaxPolls; ++i, absl::SleepFor(absl::Milliseconds(20))) {
      const v1::ServerState state = State();
      for (const v1::FileFault& fault : state.file_faults()) {
        if (fault.error().find(words) != std::string::npos) return fault;
      }
    }
    ADD_FAILURE() << "no fault with: " << words;
    return {};
  }
  // Waits until all files can be used.
  void AwaitNoFault() {
    for (int i = 0; i < kMaxPolls; ++i, absl::SleepFor(absl::Milliseconds(20))) {
      if (State().file_faults_size() == 0) return;
    }
    ADD_FAILURE() << State().DebugString();
  }
};

TEST_F(ServerStateTest, HasClockIndexAndDisk) {
  Teach("wedge", 2);
  const v1::CatalogStatus status = Status();
  const v1::ServerState& state = status.server_state();
  EXPECT_LT(std::abs(state.time().seconds() - absl::ToUnixSeconds(absl::Now())), 600);
  EXPECT_EQ(state.index_revision(), status.catalog_revision());
  EXPECT_TRUE(state.serving());
  EXPECT_GT(state.database_disk().available_byte_count(), 0);
  EXPECT_GE(state.database_disk().byte_count(), state.database_disk().available_byte_count());
  EXPECT_GT(state.database_byte_count(), 0);
  EXPECT_FALSE(state.has_certificate_expire_time());
  EXPECT_EQ(state.file_faults_size(), 0);
}

TEST_F(ServerStateTest, AWrongFileOfIdentitiesIsReportedUntilItIsRepaired) {
  WriteIdentities("{\"name\":\"reader\"}\n");
  const v1::FileFault fault = AwaitFault("line 1: roles");
  EXPECT_EQ(fault.flag(), "--identities");
  EXPECT_GT(fault.time().seconds(), 1'700'000'000);
  Add("reader", {v1::ROLE_READ});
  AwaitNoFault();
}

TEST_F(ServerStateTest, AnEmptiedFileOfIdentitiesIsReportedAndTheIdentitiesStay) {
  for (const auto& [name, emptied] : {std::pair("first", "# no identity\n"), {"second", ""}}) {
    SCOPED_TRACE(name);
    WriteIdentities(emptied);
    EXPECT_EQ(AwaitFault("has no identity").flag(), "--identities");
    EXPECT_THAT(StatusAs(token_), IsGrpcOk());
    Add(name, {v1::ROLE_READ});
    AwaitNoFault();
  }
}

TEST_F(ServerStateTest, FilesOfTlsThatDoNotFitAreReportedUntilTheyDo) {
  const Authority plant("plant");
  const KeyPair pair = plant.IssueForLoopback(1000);
  options_.tls.cert = folder_.Write("server.pem", pair.certificate).string();
  options_.tls.key = folder_.Write("server.key", pair.key).string();
  Restart();
  const std::int64_t end = State().certificate_expire_time().seconds();
  EXPECT_LE(end, absl::ToUnixSeconds(absl::Now()) + 1001);
  EXPECT_GT(end, absl::ToUnixSeconds(absl::Now()));
  folder_.Write("server.key", plant.IssueForLoopback().key);
  EXPECT_EQ(AwaitFault("is not the key of --tls-cert").flag(), "--tls-cert");
  folder_.Write("server.key", pair.key);
  AwaitNoFault();
}

TEST_F(ServerStateTest, AnAuditRecordThatCannotBeWrittenIsReported) {
  options_.audit_log = "/dev/full";
  Restart();
  EXPECT_EQ(State().file_faults_size(), 0);
  ASSERT_THAT(CreateObject("mug"), IsGrpcOk());
  const v1::ServerState state = State();
  ASSERT_EQ(state.file_faults_size(), 1);
  EXPECT_EQ(state.file_faults(0).flag(), "--audit-log");
  EXPECT_THAT(state.file_faults(0).error(), HasSubstr("cannot write --audit-log /dev/full"));
  EXPECT_EQ(state.lost_audit_record_count(), 1);
}

}  // namespace
}  // namespace graspdb::testing
