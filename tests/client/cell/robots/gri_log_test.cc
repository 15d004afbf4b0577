// What log and runner get of requests that are answered by a number only.
#include <gmock/gmock.h>
#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "client/cell/robots/gri/gri_protocol.h"
#include "tests/client/cell/robots/fake_job_runner.h"

namespace graspdb::client {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class GriLogTest : public ::testing::Test {
 protected:
  GriLogTest() { spdlog::set_default_logger(std::make_shared<spdlog::logger>("captured", log_)); }
  ~GriLogTest() override { spdlog::set_default_logger(before_); }

  void Send(const GriRequest& request) {
    const auto bytes = GriBytes(request);
    protocol_.Answer("10.3.0.7", std::string(bytes.begin(), bytes.end()));
  }

  static GriRequest Trigger(int job) {
    GriRequest out;
    out.action = static_cast<std::uint8_t>(GriAction::kTriggerJobSync);
    out.job_id = static_cast<std::uint16_t>(job);
    return out;
  }

  const std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
  const std::shared_ptr<spdlog::sinks::ringbuffer_sink_mt> log_ =
      std::make_shared<spdlog::sinks::ringbuffer_sink_mt>(16);
  FakeJobRunner runner_;
  GriJobs jobs_{runner_};
  GriProtocol protocol_{jobs_};
};

TEST_F(GriLogTest, AValidRequestIsNotRefused) {
  Send(Trigger(kFakeJob));
  EXPECT_THAT(log_->last_formatted(), IsEmpty());
}

TEST_F(GriLogTest, AnUnknownJobIsLoggedWithRobotAndReason) {
  Send(Trigger(kFakeJob + 1));
  EXPECT_THAT(log_->last_formatted(),
              ElementsAre(AllOf(HasSubstr("event=request_refused robot=10.3.0.7 job=8"),
                                HasSubstr("JOB_DOES_NOT_EXIST"), HasSubstr("no such job"))));
}

TEST_F(GriLogTest, AWrongHeaderIsLoggedWithItsFault) {
  GriRequest request = Trigger(kFakeJob);
  request.pose_format = 52;
  Send(request);
  request = Trigger(kFakeJob);
  request.version = 2;
  Send(request);
  request = Trigger(kFakeJob);
  request.action = 10;
  Send(request);
  request = Trigger(kFakeJob);
  request.length = 53;
  Send(request);
  protocol_.Answer("10.3.0.7", "RUN 1\n");
  EXPECT_THAT(log_->last_formatted(),
              ElementsAre(HasSubstr("no pose format 52"), HasSubstr("of version 2"),
                          HasSubstr("no action 10"), HasSubstr("gives 53 as its length"),
                          HasSubstr("does not begin with")));
}

TEST_F(GriLogTest, ARunGetsWhatIsWrongWithAnInvalidPose) {
  GriRequest request = Trigger(kFakeJob);
  request.pose_format = kQuaternionXyzw;
  jobs_.Answer("r", request);
  EXPECT_FALSE(runner_.base_flange);
  EXPECT_EQ(runner_.pose_fault, "") << "none was sent";
  request.pose.rotation = {1'000'000, 1'000'000, 0, 0};
  jobs_.Answer("r", request);
  EXPECT_FALSE(runner_.base_flange);
  EXPECT_THAT(runner_.pose_fault, HasSubstr("quaternion"));
}

}  // namespace
}  // namespace graspdb::client
