// The inputs of `recognize`.
#include "client/cli/recognize/scan_source.h"

#include <gmock/gmock.h>

#include "files/capture_sets/capture_set.h"
#include "files/points/point_file.h"
#include "rendering/meshes/mesh_file.h"
#include "rendering/meshes/solid.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::HasSubstr;

class ScanSourceTest : public ::testing::Test {
 protected:
  // A set with one QUERY capture of a cloud that has a VIEWPOINT.
  void WriteSet(const std::function<void(v1::CaptureSet&)>& change = {}) {
    files::PointFile file;
    file.points = {{0.1F, 0, 1}, {0, 0.1F, 1}, {0, 0, 1.1F}};
    file.width = 3;
    file.height = 1;
    file.sensor_pose = recognition::Pose(Eigen::Translation3d(0, 0, 0.5));
    ASSERT_THAT(files::WritePcd(folder_.path() / "a.pcd", file), IsOk());
    v1::CaptureSet set;
    v1::Capture* capture = set.add_captures();
    capture->set_path("a.pcd");
    capture->set_split(v1::Capture::QUERY);
    if (change) change(set);
    ASSERT_THAT(files::SaveCaptureSet(folder_.path(), set), IsOk());
  }

  absl::StatusOr<v1::RecognizeRequest> FirstRequest(const std::string& argument) {
    absl::StatusOr<ScanTasks> scans = ListScans({argument}, "ALL");
    if (!scans.ok()) return scans.status();
    return ReadScan(scans->tasks.at(0));
  }

  const files::TemporaryFolder folder_;
};

TEST_F(ScanSourceTest, FilesAndSetsMayBeMixed) {
  WriteSet();
  const std::string file = (folder_.path() / "a.pcd").string();
  const absl::StatusOr<ScanTasks> scans = ListScans({file, folder_.path().string()}, "QUERY");
  ASSERT_THAT(scans, IsOk());
  ASSERT_EQ(scans->tasks.size(), 2U);
  EXPECT_EQ(scans->tasks[0].path, file);
  EXPECT_FALSE(scans->tasks[0].in_set);
  EXPECT_EQ(scans->tasks[1].path, "a.pcd");
  EXPECT_EQ(scans->tasks[1].file, folder_.path() / "a.pcd");
  EXPECT_TRUE(scans->tasks[1].in_set);
}

// With a mesh in millimetres every pose would be within 5 % of the diameter.
TEST_F(ScanSourceTest, AMeshInMillimetresIsRejected) {
  ASSERT_THAT(rendering::WriteMeshPly(folder_.path() / "part.ply",
                                      rendering::BoxSolid({0, 0, 0}, {80, 30, 20})),
              IsOk());
  WriteSet([](v1::CaptureSet& set) {
    set.add_objects()->set_object_id("part");
    set.mutable_objects(0)->set_mesh_path("part.ply");
  });
  EXPECT_THAT(ListScans({folder_.path().string()}, "ALL"),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("unit is probably mm")));
}

TEST_F(ScanSourceTest, AFileGivesTheSensorPoseOfItsViewpoint) {
  WriteSet();
  const auto request = FirstRequest((folder_.path() / "a.pcd").string());
  ASSERT_THAT(request, IsOk());
  EXPECT_EQ(request->sensor_pose().position().z(), 0.5);
  EXPECT_EQ(request->cloud().data().size(), 36U);
  EXPECT_EQ(request->cloud().width(), 0) << "one row is not an image";
  EXPECT_FALSE(request->segmented());
  EXPECT_FALSE(request->has_region_of_interest());
}

TEST_F(ScanSourceTest, TheSetOverridesTheFile) {
  WriteSet([](v1::CaptureSet& set) {
    set.mutable_region_of_interest()->mutable_max()->set_x(1);
    v1::Capture* capture = set.mutable_captures(0);
    capture->set_segmented(true);
    capture->mutable_sensor_pose()->mutable_position()->set_z(0.7);
    capture->mutable_sensor_pose()->mutable_orientation()->set_w(1);
  });
  const auto request = FirstRequest(folder_.path().string());
  ASSERT_THAT(request, IsOk());
  EXPECT_EQ(request->sensor_pose().position().z(), 0.7);
  EXPECT_TRUE(request->segmented());
  EXPECT_EQ(request->region_of_interest().max().x(), 1);
}

TEST_F(ScanSourceTest, AnEmptySplitIsAnError) {
  WriteSet();
  EXPECT_THAT(ListScans({folder_.path().string()}, "TEACH"),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("choose another --split")));
}

TEST_F(ScanSourceTest, AMissingFileIsReportedWhenItIsRead) {
  EXPECT_THAT(FirstRequest("/nonexistent/a.pcd"),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("/nonexistent/a.pcd")));
}

}  // namespace
}  // namespace graspdb::client
