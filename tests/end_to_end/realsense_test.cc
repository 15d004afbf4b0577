// Real frames without calibration: taught objects are recognized, others rejected.
#include <gmock/gmock.h>

#include <filesystem>

#include "files/capture_sets/capture_set.h"
#include "tests/end_to_end/fixtures/outcome_matchers.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"
#include "tests/recognition/scenes/shared_data.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::end_to_end {
namespace {

using ::graspdb::testing::IsOk;

constexpr const char* kObjects[] = {"blue_mug", "cylinder", "green_bowl", "pepper", "red_mug"};

// The parameter is the object that is not taught; none for "".
class RealsenseTest : public ProgramsTest, public ::testing::WithParamInterface<std::string> {
 protected:
  void SetUp() override {
    const auto folder = graspdb::testing::SharedData("realsense_tabletop");
    if (!folder) GTEST_SKIP() << graspdb::testing::SharedDataMissing("realsense_tabletop");
    frames_ = *folder;
    StartServer();
    Teach();
  }

  // Recognizes the front object in the full frame of that object.
  v1::RecognizeResponse RecognizeFront(const std::string& object) {
    const std::string line =
        Succeed({"recognize", (frames_ / (object + ".pcd")).string(), "--json"}).out;
    const auto response = ResponseOf(line.substr(0, line.find('\n')));
    EXPECT_TRUE(response) << line;
    return response.value_or(v1::RecognizeResponse());
  }

  std::filesystem::path frames_;

 private:
  // The segmented clouds, with sensor poses from the tables of the full frames.
  void Teach() {
    v1::CaptureSet set;
    std::filesystem::create_directories(Path("set"));
    for (const std::string object : kObjects) {
      if (object == GetParam()) continue;
      v1::CapturedObject* declared = set.add_objects();
      declared->set_object_id(object);
      declared->add_stable_poses()->set_stable_pose_id("upright");
      v1::Capture* capture = set.add_captures();
      capture->set_path(object + ".pcd");
      capture->set_split(v1::Capture::TEACH);
      capture->set_object_id(object);
      capture->set_stable_pose_id("upright");
      capture->set_segmented(true);
      *capture->mutable_sensor_pose() = RecognizeFront(object).sensor_pose();
      std::filesystem::copy_file(frames_ / (object + "_object.pcd"),
                                 Path("set/" + object + ".pcd"));
    }
    ASSERT_THAT(files::SaveCaptureSet(Path("set"), set), IsOk());
    Succeed({"import", Path("set")});
  }
};

TEST_P(RealsenseTest, RecognizesOrRejectsTheFrontObject) {
  for (const std::string object : kObjects) {
    const v1::RecognizeResponse answer = RecognizeFront(object);
    ASSERT_GT(answer.detections_size(), 0) << object;
    const v1::Detection& front = answer.detections(0);
    if (object == GetParam()) {
      EXPECT_EQ(front.status(), v1::UNKNOWN_OBJECT) << object << " taken for " << front.object();
      EXPECT_NE(front.rejected_by(), v1::REJECTION_GATE_UNSPECIFIED);
    } else {
      EXPECT_EQ(front.object(), "objects/" + object);
      EXPECT_GT(front.score(), 0.9) << object;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(NotTaught, RealsenseTest,
                         ::testing::Values("", "blue_mug", "cylinder", "green_bowl", "pepper",
                                           "red_mug"),
                         [](const auto& which) -> std::string {
                           return which.param.empty() ? "none" : which.param;
                         });

}  // namespace
}  // namespace graspdb::end_to_end
