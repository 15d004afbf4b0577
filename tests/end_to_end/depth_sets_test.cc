// Capture sets of depth images.
#include <gmock/gmock.h>

#include <cmath>
#include <sstream>

#include "files/capture_sets/capture_set.h"
#include "files/depth/depth_png.h"
#include "files/messages/scan_message.h"
#include "files/points/point_file.h"
#include "rendering/camera/depth_camera.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::end_to_end {
namespace {

using ::graspdb::testing::IsOk;

constexpr double kUnitM = 0.0001;

class DepthSetsTest : public ProgramsTest {
 protected:
  // The captures of "set" as depth images in the set "images", and as the points of these in the
  // set "clouds".
  void SetUp() override {
    Simulate("set", 90, 2);
    auto images = files::LoadCaptureSet(Path("set"));
    ASSERT_THAT(images, IsOk());
    v1::CaptureSet clouds = *images;
    for (int i = 0; i < clouds.captures_size(); ++i) {
      const std::string id = "v" + std::to_string(i);
      Convert(clouds.captures(i).path(), id);
      images->mutable_captures(i)->set_path(id + ".png");
      clouds.mutable_captures(i)->set_path(id + ".pcd");
      for (v1::CaptureSet* set : {&*images, &clouds}) set->mutable_captures(i)->set_view_id(id);
    }
    for (v1::CaptureSet* set : {&*images, &clouds}) {
      for (v1::CapturedObject& object : *set->mutable_objects()) object.clear_mesh_path();
    }
    ASSERT_THAT(files::WriteIntrinsics(Path("images/intrinsics.json"), {kCamera, kUnitM}), IsOk());
    ASSERT_THAT(files::SaveCaptureSet(Path("images"), *images), IsOk());
    ASSERT_THAT(files::SaveCaptureSet(Path("clouds"), clouds), IsOk());
  }

  void Convert(const std::string& path, const std::string& id) {
    auto file = files::ReadPointFile(Path("set/" + path));
    ASSERT_THAT(file, IsOk());
    std::vector<std::uint16_t> counts;
    for (const Eigen::Vector3f& p : file->points) {
      const double depth = std::isnan(p.z()) ? 0 : static_cast<double>(p.z());
      counts.push_back(static_cast<std::uint16_t>(std::lround(depth / kUnitM)));
    }
    const v1::DepthImage image = files::DepthMessage(counts, kCamera, kUnitM);
    ASSERT_THAT(files::WriteDepthPng(Path("images/" + id + ".png"), image), IsOk());
    const auto points = files::PointsFromMessage(image);
    ASSERT_THAT(points, IsOk());
    file->points = *points;
    ASSERT_THAT(files::WritePcd(Path("clouds/" + id + ".pcd"), *file), IsOk());
  }

  // Teaches the set on a server of its own and writes the views to a folder; returns its answers.
  std::vector<std::string> Answers(const std::string& set) {
    StartServer(set + ".db");
    Succeed({"import", Path(set)});
    EXPECT_THAT(Succeed({"import", Path(set)}).out, ::testing::HasSubstr("taught 0 views"));
    Succeed({"export", Path(set + ".views")});
    std::istringstream lines(Recognize(set));
    std::vector<std::string> out;
    for (std::string line; std::getline(lines, line);) {
      out.push_back(ResponseOf(line).value_or(v1::RecognizeResponse()).SerializeAsString());
    }
    return out;
  }

  const recognition::CameraIntrinsics kCamera = rendering::KinectV2().intrinsics;
};

TEST_F(DepthSetsTest, GiveTheViewsAndTheAnswersOfTheirClouds) {
  const std::vector<std::string> answers = Answers("images");
  EXPECT_EQ(answers.size(), 2U);
  EXPECT_EQ(answers, Answers("clouds"));
  const auto views = files::LoadCaptureSet(Path("images.views"));
  ASSERT_THAT(views, IsOk());
  EXPECT_EQ(views->captures_size(), 12);
  for (const v1::Capture& view : views->captures()) {
    EXPECT_EQ(files::BytesOf(Path("images.views/" + view.path())),
              files::BytesOf(Path("clouds.views/" + view.path())));
  }
  EXPECT_EQ(files::BytesOf(Path("images.views/captures.json")),
            files::BytesOf(Path("clouds.views/captures.json")));
}

}  // namespace
}  // namespace graspdb::end_to_end
