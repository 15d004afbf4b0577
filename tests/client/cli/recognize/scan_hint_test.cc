#include <gmock/gmock.h>

#include "client/cli/recognize/commands.h"
#include "files/messages/scan_message.h"

namespace graspdb::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

v1::RecognizeRequest ImageOf(std::uint16_t count) {
  v1::RecognizeRequest request;
  *request.mutable_depth_image() =
      files::DepthMessage(std::vector<std::uint16_t>(100, count), {10, 10, 50, 50, 5, 5}, 0.001);
  return request;
}

v1::RecognizeResponse AnswerOf(v1::RecognitionStatus status) {
  v1::RecognizeResponse response;
  response.set_status(status);
  return response;
}

TEST(ScanHint, CountsOfAnotherUnitAreSuspected) {
  for (const auto status : {v1::EMPTY_REGION, v1::NO_CLUSTER, v1::UNKNOWN_OBJECT}) {
    EXPECT_THAT(ScanHint(ImageOf(3300), AnswerOf(status)),
                AllOf(HasSubstr("3.3 m in front of"), HasSubstr("depthUnitM")));
  }
}

TEST(ScanHint, AnEmptyRegionStatesWhereThePointsAreInTheWorld) {
  v1::RecognizeResponse response = AnswerOf(v1::EMPTY_REGION);
  response.mutable_sensor_pose()->mutable_position()->set_z(4);
  response.mutable_sensor_pose()->mutable_orientation()->set_w(1);
  EXPECT_THAT(ScanHint(ImageOf(650), response),
              AllOf(HasSubstr("4.65) m in the world frame"), HasSubstr("VIEWPOINT")));
}

TEST(ScanHint, PointsBehindTheCameraAreReported) {
  v1::RecognizeRequest request;
  *request.mutable_cloud() = files::CloudMessage(recognition::Points(50, {0, 0.1F, -0.6F}), 0);
  EXPECT_THAT(ScanHint(request, AnswerOf(v1::UNKNOWN_OBJECT)), HasSubstr("OpenGL"));
}

TEST(ScanHint, AnAnswerThatIsNotOfTheDistanceHasNone) {
  EXPECT_EQ(ScanHint(ImageOf(3300), AnswerOf(v1::OK)), "");
  EXPECT_EQ(ScanHint(ImageOf(650), AnswerOf(v1::UNKNOWN_OBJECT)), "");
  EXPECT_EQ(ScanHint(ImageOf(0), AnswerOf(v1::EMPTY_REGION)), "");
}

}  // namespace
}  // namespace graspdb::client
