// Files played as a camera.
#include "client/cell/sensors/files/file_sensor.h"

#include <gmock/gmock.h>

#include "files/capture_sets/capture_set.h"
#include "files/depth/depth_png.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "files/points/point_file.h"
#include "tests/files/temporary_folder.h"
#include "tests/recognition/scenes/shared_data.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

const files::DepthPngCamera small_camera = {
    .intrinsics = {.width = 2, .height = 1, .fx = 500, .fy = 500, .cx = 0.5, .cy = 0},
    .depth_unit_m = 0.001};

void WriteImage(const std::filesystem::path& path, std::uint16_t depth) {
  ASSERT_THAT(
      files::WriteDepthPng(path, files::DepthMessage({depth, 0}, small_camera.intrinsics, 0.001)),
      IsOk());
}

files::PointFile OnePoint(float z) {
  return {.points = {{0, 0, z}}, .normals = {}, .width = 1, .height = 1, .sensor_pose = {}};
}

std::unique_ptr<FileSensor> Play(const std::filesystem::path& path,
                                 const FilePlayback& playback = {}) {
  auto sensor = FileSensor::Open(path, playback);
  EXPECT_THAT(sensor, IsOk());
  return sensor.ok() ? *std::move(sensor) : nullptr;
}

std::uint16_t FirstDepth(const absl::StatusOr<SensorFrame>& frame) {
  if (!frame.ok()) return 0;
  const auto counts = files::CountsFromMessage(std::get<v1::DepthImage>(frame->scan));
  return counts.ok() ? counts->front() : 0;
}

TEST(FileSensor, PlaysAFolderInOrderOfNamesAndIsThenUnavailable) {
  const files::TemporaryFolder folder;
  WriteImage(folder.path() / "b.png", 2);
  WriteImage(folder.path() / "a.png", 1);
  ASSERT_THAT(files::WritePcd(folder.path() / "c.pcd", OnePoint(0.5F)), IsOk());
  folder.Write("notes.txt", "passed over");
  ASSERT_THAT(files::WriteIntrinsics(folder.path() / files::kIntrinsicsFile, small_camera), IsOk());
  const auto sensor = Play(folder.path());
  EXPECT_EQ(FirstDepth(sensor->Next(MonotonicTime::InfiniteFuture())), 1);
  EXPECT_EQ(FirstDepth(sensor->Next(MonotonicTime::InfiniteFuture())), 2);
  const auto points = sensor->Next(MonotonicTime::InfiniteFuture());
  ASSERT_THAT(points, IsOk());
  EXPECT_TRUE(std::holds_alternative<v1::PointCloud>(points->scan));
  EXPECT_FALSE(sensor->IsReady());
  EXPECT_TRUE(sensor->HasEnded());
  EXPECT_THAT(sensor->Next(MonotonicTime::InfiniteFuture()),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("?loop")));
}

TEST(FileSensor, LoopsIfSet) {
  const files::TemporaryFolder folder;
  WriteImage(folder.path() / "a.png", 1);
  WriteImage(folder.path() / "b.png", 2);
  ASSERT_THAT(files::WriteIntrinsics(folder.path() / files::kIntrinsicsFile, small_camera), IsOk());
  const auto sensor = Play(folder.path(), {.loop = true});
  for (const int expected : {1, 2, 1, 2, 1}) {
    EXPECT_EQ(FirstDepth(sensor->Next(MonotonicTime::InfiniteFuture())), expected);
    EXPECT_TRUE(sensor->IsReady());
    EXPECT_FALSE(sensor->HasEnded());
  }
}

TEST(FileSensor, AFrameHasTheTimeOfItsReading) {
  const files::TemporaryFolder folder;
  WriteImage(folder.path() / "a.png", 1);
  ASSERT_THAT(files::WriteIntrinsics(folder.path() / files::kIntrinsicsFile, small_camera), IsOk());
  const MonotonicTime before = MonotonicTime::Now();
  const auto frame = Play(folder.path() / "a.png")->Next(MonotonicTime::InfiniteFuture());
  ASSERT_THAT(frame, IsOk());
  EXPECT_GE(frame->time, before);
  EXPECT_LE(frame->time, MonotonicTime::Now());
  const auto& image = std::get<v1::DepthImage>(frame->scan);
  EXPECT_TRUE(image.has_capture_time());
}

TEST(FileSensor, AFrameThatIsNotDueExceedsTheDeadline) {
  const files::TemporaryFolder folder;
  WriteImage(folder.path() / "a.png", 1);
  ASSERT_THAT(files::WriteIntrinsics(folder.path() / files::kIntrinsicsFile, small_camera), IsOk());
  const auto sensor = Play(folder.path(), {.loop = true, .rate_hz = 0.001});
  EXPECT_THAT(sensor->Next(MonotonicTime::Now() + absl::Seconds(1)), IsOk());
  EXPECT_THAT(sensor->Next(MonotonicTime::Now() + absl::Seconds(1)),
              StatusIs(absl::StatusCode::kDeadlineExceeded));
}

TEST(FileSensor, ABadFileIsReportedAndTheNextOneFollows) {
  const files::TemporaryFolder folder;
  folder.Write("a.png", "rubbish");
  WriteImage(folder.path() / "b.png", 2);
  ASSERT_THAT(files::WriteIntrinsics(folder.path() / files::kIntrinsicsFile, small_camera), IsOk());
  const auto sensor = Play(folder.path());
  EXPECT_THAT(sensor->Next(MonotonicTime::InfiniteFuture()),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("a.png")));
  EXPECT_EQ(FirstDepth(sensor->Next(MonotonicTime::InfiniteFuture())), 2);
}

TEST(FileSensor, DepthsWithoutIntrinsicsAreAnError) {
  const files::TemporaryFolder folder;
  WriteImage(folder.path() / "a.png", 1);
  EXPECT_THAT(Play(folder.path())->Next(MonotonicTime::InfiniteFuture()),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("intrinsics.json")));
}

TEST(FileSensor, ACaptureSetHasItsOrderAndItsSensorPoses) {
  const files::TemporaryFolder folder;
  ASSERT_THAT(files::WritePcd(folder.path() / "z.pcd", OnePoint(0.5F)), IsOk());
  ASSERT_THAT(files::WritePcd(folder.path() / "a.pcd", OnePoint(0.7F)), IsOk());
  v1::CaptureSet set;
  v1::Capture* first = set.add_captures();
  first->set_path("z.pcd");
  recognition::Pose pose = recognition::Pose::Identity();
  pose.translation() = Eigen::Vector3d(1, 2, 3);
  *first->mutable_sensor_pose() = files::ToMessage(pose);
  set.add_captures()->set_path("a.pcd");
  ASSERT_THAT(files::SaveCaptureSet(folder.path(), set), IsOk());
  const auto sensor = Play(folder.path());
  const auto posed = sensor->Next(MonotonicTime::InfiniteFuture());
  ASSERT_THAT(posed, IsOk());
  ASSERT_TRUE(posed->world_sensor.has_value());
  EXPECT_EQ(posed->world_sensor->translation(), pose.translation());
  const auto unposed = sensor->Next(MonotonicTime::InfiniteFuture());
  ASSERT_THAT(unposed, IsOk());
  EXPECT_FALSE(unposed->world_sensor.has_value());
}

TEST(FileSensor, UnplayablePathsAreRejectedAtOnce) {
  const files::TemporaryFolder folder;
  EXPECT_THAT(FileSensor::Open(folder.path() / "none", {}),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("none")));
  EXPECT_THAT(FileSensor::Open(folder.path(), {}),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr(".pcd")));
  EXPECT_THAT(FileSensor::Open(folder.Write("a.txt", "text"), {}),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("nothing to play")));
}

// A real frame.
TEST(FileSensor, PlaysRealFrames) {
  const auto frames = testing::SharedData("realsense_tabletop");
  if (!frames) GTEST_SKIP() << testing::SharedDataMissing("realsense_tabletop");
  const auto frame = Play(*frames)->Next(MonotonicTime::InfiniteFuture());
  ASSERT_THAT(frame, IsOk());
  const auto& cloud = std::get<v1::PointCloud>(frame->scan);
  EXPECT_EQ(cloud.width(), 640);
  EXPECT_EQ(cloud.data().size(), 12U * 640 * 480);
}

}  // namespace
}  // namespace graspdb::client
