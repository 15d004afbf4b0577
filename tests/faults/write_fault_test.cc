// A server whose files reach a limit of the system while it runs: it says so, and needs no restart.
#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <sys/resource.h>

#include <chrono>
#include <filesystem>
#include <iterator>
#include <thread>

#include "tests/faults/fault_fixture.h"
#include "tests/server/raw_call.h"
#include "tests/testing/scrape.h"

namespace graspdb::faults {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// grpc.health.v1.HealthCheckRequest of the service graspdb.writes, and the responses.
constexpr char kWrites[] = "\x0a\x0egraspdb.writes";
constexpr char kServing[] = "\x08\x01";
constexpr char kNotServing[] = "\x08\x02";

class WriteFaultTest : public FaultTest {
 protected:
  void Start() {
    Prepare();
    StartServer("db", {"--metrics-listen", "127.0.0.1:0"});
    const std::string url = server_->WaitForLine("metrics on http://");
    metrics_ = url.substr(0, url.find('/'));
  }
  // The limit from now on; the one before.
  rlimit Limit(__rlimit_resource resource, rlim_t soft) const {
    rlimit before{};
    prlimit(server_->id(), resource, nullptr, &before);
    const rlimit limit{soft, before.rlim_max};
    prlimit(server_->id(), resource, &limit, nullptr);
    return before;
  }
  std::string Health(const std::string& request) const {
    testing::RawCall check(channel_, "/grpc.health.v1.Health/Check");
    return check.Write(request) ? check.Read().value_or("") : "";
  }
  double Failed() const {
    return testing::ValueOf(testing::HttpGet(metrics_, "/metrics"),
                            "graspdb_database_writes_failed");
  }
  // Waits until the server reports this.
  void AwaitHealth(const std::string& writes) const {
    while (Health(kWrites) != writes) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  void Connect() {
    channel_ = grpc::CreateChannel(address_, grpc::InsecureChannelCredentials());
    ASSERT_EQ(Health(""), kServing);
    AwaitHealth(kServing);
  }
  void ExpectFault(const std::string& reason) const {
    AwaitHealth(kNotServing);
    EXPECT_EQ(Health(""), kServing) << "frames are recognised";
    EXPECT_EQ(Failed(), 1);
    EXPECT_THAT(Succeed({"status"}).out, HasSubstr("writes      fail since "));
    const end_to_end::Finished doctor = Graspdb({"doctor"});
    EXPECT_EQ(doctor.exit_status, 1);
    EXPECT_THAT(doctor.out, HasSubstr("error    server: writes fail since "));
    EXPECT_THAT(doctor.out, HasSubstr(reason));
  }
  void ExpectNoFault() const {
    AwaitHealth(kServing);
    EXPECT_EQ(Failed(), 0);
    EXPECT_THAT(Succeed({"status"}).out, Not(HasSubstr("fail since ")));
    EXPECT_THAT(Graspdb({"doctor"}).out, Not(HasSubstr("writes fail")));
    EXPECT_TRUE(server_->WaitForError("event=writes_resumed"));
  }

  std::string metrics_;
  std::shared_ptr<grpc::Channel> channel_;
};

TEST_F(WriteFaultTest, AWriteThatFailsIsReportedAndWritesResumeOnceTheyCan) {
  Start();
  client::Client client = FaultTest::Connect();
  ASSERT_EQ(samples_.Prepare(client), absl::OkStatus());
  ASSERT_NO_FATAL_FAILURE(Connect());
  int taught = 0;
  for (int round = 0; round < 3; ++round) {
    for (const int more = taught + 3; taught < more; ++taught) {
      ASSERT_EQ(Teach(client, taught), absl::OkStatus());
    }
    // Shorter than the database's log is, and the server's own.
    const rlimit before = Limit(RLIMIT_FSIZE, 4096);
    const absl::Status refused = Teach(client, taught);
    EXPECT_TRUE(absl::IsUnavailable(refused)) << refused;
    EXPECT_THAT(std::string(refused.message()), HasSubstr("File too large"));
    ExpectFault("File too large");
    for (int i = 0; i < taught; ++i) ExpectView(client, i);
    EXPECT_EQ(client.Recognize(samples_.Scan(0))->detections(0).candidates(0).view(), NameOf(0));

    Limit(RLIMIT_FSIZE, before.rlim_cur);
    ExpectNoFault();
    ASSERT_EQ(Teach(client, taught), absl::OkStatus());
    ++taught;
  }
  server_->Signal(SIGKILL);
  server_->Wait();
  StartServer("db");
  client::Client restarted = FaultTest::Connect();
  for (int i = 0; i < taught; ++i) ExpectView(restarted, i);
  EXPECT_EQ(restarted.GetCatalogStatus()->view_count(), taught);
}

TEST_F(WriteFaultTest, AFullTableOfDescriptorsIsFoundWithoutAWrite) {
  Start();
  client::Client client = FaultTest::Connect();
  ASSERT_EQ(samples_.Prepare(client), absl::OkStatus());
  ASSERT_NO_FATAL_FAILURE(Connect());
  const std::filesystem::directory_iterator files(absl::StrCat("/proc/", server_->id(), "/fd"));
  const auto open = static_cast<rlim_t>(std::distance(begin(files), end(files)));
  const rlimit before = Limit(RLIMIT_NOFILE, open + 20);  // room for the calls of the test
  ExpectFault("file descriptors");
  EXPECT_TRUE(server_->WaitForError("event=writes_failed"));
  EXPECT_EQ(Teach(client, 0), absl::OkStatus()) << "the log is open";
  Limit(RLIMIT_NOFILE, before.rlim_cur);
  ExpectNoFault();
  ASSERT_EQ(Teach(client, 1), absl::OkStatus());
  server_->Signal(SIGTERM);
  EXPECT_EQ(server_->Wait().exit_status, 0);
}

}  // namespace
}  // namespace graspdb::faults
