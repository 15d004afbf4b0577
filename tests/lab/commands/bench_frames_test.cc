// Requests of `bench`.
#include "lab/commands/bench_frames.h"

#include <gmock/gmock.h>

#include "files/points/point_file.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::lab {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::HasSubstr;

class BenchFramesTest : public ::testing::Test {
 protected:
  // The requests of `bench` with these arguments.
  absl::StatusOr<std::vector<v1::RecognizeRequest>> Requests(const std::string& words) {
    CLI::App app;
    BenchFrames frames;
    AddFrameOptions(app, &frames);
    app.parse(words);
    return MakeRequests(frames);
  }

  std::string WriteScan(const std::string& name) {
    files::PointFile file;
    file.points = {{0.1F, 0, 1}, {0, 0.1F, 1}, {0, 0, 1.1F}};
    file.width = 3;
    file.height = 1;
    std::string path = (folder_.path() / name).string();
    EXPECT_THAT(files::WritePcd(path, file), IsOk());
    return path;
  }

  const files::TemporaryFolder folder_;
};

TEST_F(BenchFramesTest, AppliesTheSettingsToEveryScan) {
  const std::string words = WriteScan("a.pcd") + " " + WriteScan("b.pcd") +
                            " --cell press --segmented --verified-views 3 --min-score 0.5";
  const auto requests = Requests(words);
  ASSERT_THAT(requests, IsOk());
  ASSERT_EQ(requests->size(), 2U);
  for (const v1::RecognizeRequest& request : *requests) {
    EXPECT_EQ(request.cloud().data().size(), 36U);
    EXPECT_EQ(request.cell(), "cells/press");
    EXPECT_TRUE(request.segmented());
    EXPECT_EQ(request.pipeline().verified_view_count(), 3);
    EXPECT_EQ(request.pipeline().min_score(), 0.5);
  }
  EXPECT_EQ(DescribeRequests(*requests), "2 clouds, 0.00 MB each");
}

TEST_F(BenchFramesTest, MoreViewsThanTheServerVerifiesAreWrongUsage) {
  EXPECT_THAT(Requests(WriteScan("a.pcd") + " --verified-views 100"), IsOk());
  EXPECT_THROW((void)Requests(WriteScan("a.pcd") + " --verified-views 101"), CLI::ValidationError);
}

TEST_F(BenchFramesTest, LeavesUnsetFieldsToTheServer) {
  const auto requests = Requests(WriteScan("a.pcd"));
  ASSERT_THAT(requests, IsOk());
  EXPECT_FALSE(requests->front().pipeline().has_verified_view_count());
  EXPECT_FALSE(requests->front().pipeline().has_min_score());
  EXPECT_EQ(requests->front().cell(), "");
}

TEST_F(BenchFramesTest, ReportsAMissingScanBeforeTheRun) {
  EXPECT_THAT(Requests(WriteScan("a.pcd") + " /nonexistent/b.pcd"),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("/nonexistent/b.pcd")));
}

TEST_F(BenchFramesTest, LimitsTheNumberOfFrames) {
  const std::string scans = WriteScan("a.pcd") + " " + WriteScan("b.pcd");
  EXPECT_EQ(Requests(scans + " --frames 1")->size(), 1U);
  EXPECT_EQ(Requests(scans + " --frames 5")->size(), 2U);
  const auto simulated = Requests("--simulate --parts wedge --frames 2");
  ASSERT_THAT(simulated, IsOk());
  ASSERT_EQ(simulated->size(), 2U);
  EXPECT_EQ(DescribeRequests(*simulated), "2 depth images of 512 x 424, 0.43 MB each");
}

}  // namespace
}  // namespace graspdb::lab
