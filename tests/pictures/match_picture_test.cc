#include "pictures/match_picture.h"

#include <gmock/gmock.h>

#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::pictures {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;

// A sensor 1 m above the table that looks straight down.
MatchPicture LookingDown() {
  MatchPicture picture;
  picture.world_sensor.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  picture.world_sensor.translation() = Eigen::Vector3d(0, 0, 1);
  return picture;
}

std::string BytesOfPicture(const MatchPicture& picture) {
  const files::TemporaryFolder folder;
  const auto path = folder.path() / "picture.png";
  EXPECT_THAT(WriteMatchPicture(path, picture), IsOk());
  return files::BytesOf(path);
}

TEST(MatchPicture, IsAPngWithTheGivenPoints) {
  MatchPicture picture = LookingDown();
  const std::string empty = BytesOfPicture(picture);
  EXPECT_THAT(empty, ::testing::StartsWith("\x89PNG\r\n"));
  EXPECT_EQ(BytesOfPicture(picture), empty);
  picture.scan = {{0.01F, 0.02F, 0.03F}};
  const std::string with_scan = BytesOfPicture(picture);
  EXPECT_NE(with_scan, empty);
  picture.world_tcp = recognition::Pose::Identity();
  EXPECT_NE(BytesOfPicture(picture), with_scan);
}

TEST(MatchPicture, PointsBehindTheSensorAreLeftOut) {
  MatchPicture picture = LookingDown();
  const std::string empty = BytesOfPicture(picture);
  picture.scan = {{0, 0, 2}, {0, 0, 100}};
  EXPECT_EQ(BytesOfPicture(picture), empty);
}

TEST(MatchPicture, AnObjectAtTheSensorDoesNotCrash) {
  MatchPicture picture = LookingDown();
  picture.center = picture.world_sensor.translation();
  picture.scan = {{0, 0, 1}};
  EXPECT_THAT(BytesOfPicture(picture), ::testing::StartsWith("\x89PNG"));
}

TEST(MatchPicture, AMissingFolderIsAnError) {
  EXPECT_THAT(WriteMatchPicture("/nonexistent/folder/picture.png", LookingDown()),
              StatusIs(absl::StatusCode::kFailedPrecondition,
                       ::testing::HasSubstr("choose another folder")));
}

}  // namespace
}  // namespace graspdb::pictures
