// Full queues, deadlines and cancelled calls.
#include <gmock/gmock.h>

#include <optional>
#include <thread>

#include "tests/files/temporary_folder.h"
#include "tests/server/error_details.h"
#include "tests/server/sample_captures.h"
#include "tests/server/service_rig.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

constexpr int kLongMs = 300'000;
constexpr auto kNever = [] { return false; };

class OverloadTest : public ::testing::Test {
 protected:
  static v1::RecognizeRequest Request() {
    v1::RecognizeRequest request;
    const Frame frame = PhotographEmptyTable();
    *request.mutable_depth_image() = DepthImageOf(frame);
    *request.mutable_sensor_pose() = PoseMessage(frame.world_sensor);
    return request;
  }

  const files::TemporaryFolder folder_;
  const std::string database_ = (folder_.path() / "db").string();
};

TEST_F(OverloadTest, FullQueueRejectsCallsUntilASlotIsFree) {
  ServiceRig rig(database_, /*slots=*/1, /*waiting=*/0);
  {
    const auto occupied = rig.admission().Enter(kNever);
    ASSERT_THAT(occupied, IsOk());
    const grpc::Status status = rig.Recognize(Request(), kLongMs);
    ExpectError(status, grpc::StatusCode::RESOURCE_EXHAUSTED, "try again");
    EXPECT_EQ(ReasonOf(status), "QUEUE_FULL");
  }
  EXPECT_THAT(rig.Recognize(Request(), kLongMs), IsGrpcOk());
}

TEST_F(OverloadTest, ACallWaitsForItsSlot) {
  ServiceRig rig(database_, /*slots=*/1, /*waiting=*/1);
  auto occupied = std::optional(rig.admission().Enter(kNever));
  ASSERT_THAT(*occupied, IsOk());
  grpc::Status status;
  std::thread caller([&] { status = rig.Recognize(Request(), kLongMs); });
  occupied.reset();
  caller.join();
  EXPECT_THAT(status, IsGrpcOk());
}

TEST_F(OverloadTest, ExpiredCallReleasesItsPlace) {
  ServiceRig rig(database_, /*slots=*/1, /*waiting=*/1);
  {
    const auto occupied = rig.admission().Enter(kNever);
    ASSERT_THAT(occupied, IsOk());
    EXPECT_EQ(rig.Recognize(Request(), 30).error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
    // The place is free again once the server has noticed; the next caller is cancelled
    // while it waits, and not rejected.
    const auto always = [] { return true; };
    absl::Status status = rig.admission().Enter(always).status();
    while (absl::IsResourceExhausted(status)) status = rig.admission().Enter(always).status();
    EXPECT_THAT(status, StatusIs(absl::StatusCode::kCancelled));
  }
  EXPECT_THAT(rig.Recognize(Request(), kLongMs), IsGrpcOk());
}

TEST_F(OverloadTest, CancelledFrameIsNotProcessedFurther) {
  ServiceRig rig(database_, 1, 0);
  int checks = 0;
  ASSERT_THAT(rig.recognizer().Answer(Request(),
                                      [&] {
                                        ++checks;
                                        return false;
                                      }),
              IsOk());
  ASSERT_GE(checks, 2);
  for (int stop_at = 1; stop_at <= checks; ++stop_at) {
    int count = 0;
    const auto answer = rig.recognizer().Answer(Request(), [&] { return ++count == stop_at; });
    EXPECT_THAT(answer, StatusIs(absl::StatusCode::kCancelled));
    EXPECT_EQ(count, stop_at);
  }
}

}  // namespace
}  // namespace graspdb::testing
