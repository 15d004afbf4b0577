#include "client/cell/agent/settings/job_config.h"

#include <gmock/gmock.h>

#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::HasSubstr;

TEST(ParseJob, AnyHasNoFilter) {
  const auto job = ParseJob("1 any");
  ASSERT_THAT(job, IsOk());
  EXPECT_EQ(job->id, 1);
  EXPECT_EQ(job->kind, JobKind::kRecognize);
  EXPECT_EQ(job->object, "");
  EXPECT_EQ(job->label, "");
  EXPECT_EQ(job->primary, JobPrimary::kGrasp);
  EXPECT_FALSE(job->time_limit);
}

TEST(ParseJob, ParsesAllWords) {
  const auto job = ParseJob(
      "65535\tobject=flange  primary=object limit=500ms min-score=0.8 poses=3 protocol=line");
  ASSERT_THAT(job, IsOk());
  EXPECT_EQ(job->id, 65535);
  EXPECT_EQ(job->object, "objects/flange");
  EXPECT_EQ(job->primary, JobPrimary::kObject);
  EXPECT_EQ(job->time_limit, absl::Milliseconds(500));
  EXPECT_EQ(job->min_score, 0.8);
  EXPECT_EQ(job->max_poses, 3U);
  EXPECT_EQ(job->protocol, JobProtocol::kLine);
}

TEST(ParseJob, ParsesAShownGrasp) {
  const auto job = ParseJob(
      "80 show=top opening=0.06 approach=0.12 retreat=0.05 priority=-2 object=objects/mug");
  ASSERT_THAT(job, IsOk());
  EXPECT_EQ(job->kind, JobKind::kShowGrasp);
  EXPECT_EQ(job->shown_grasp.grasp_id(), "top");
  EXPECT_EQ(job->object, "objects/mug");
  EXPECT_EQ(job->shown_grasp.gripper_opening_m(), 0.06);
  EXPECT_EQ(job->shown_grasp.approach_distance_m(), 0.12);
  EXPECT_EQ(job->shown_grasp.retreat_distance_m(), 0.05);
  EXPECT_EQ(job->shown_grasp.priority(), -2);
}

TEST(ParseJob, AShownGraspMovesTenCentimetresByDefault) {
  const auto job = ParseJob("80 show=top");
  ASSERT_THAT(job, IsOk());
  EXPECT_EQ(job->shown_grasp.approach_distance_m(), 0.1);
  EXPECT_EQ(job->shown_grasp.retreat_distance_m(), 0.1);
  EXPECT_EQ(job->shown_grasp.gripper_opening_m(), 0);
}

TEST(ParseJob, ParsesOutcomes) {
  EXPECT_EQ(ParseJob("1 outcome=picked")->kind, JobKind::kPicked);
  EXPECT_EQ(ParseJob("1 outcome=missed")->kind, JobKind::kMissed);
  EXPECT_EQ(ParseJob("1 outcome=slipped")->kind, JobKind::kSlipped);
}

struct BadJob {
  const char* line;
  const char* message;
};

class BadJobTest : public ::testing::TestWithParam<BadJob> {};

TEST_P(BadJobTest, IsRejectedWithTheLineAndTheAllowedWords) {
  const auto job = ParseJob(GetParam().line);
  EXPECT_THAT(job, StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(GetParam().message)));
  EXPECT_THAT(std::string(job.status().message()), HasSubstr(GetParam().line));
}

INSTANTIATE_TEST_SUITE_P(
    All, BadJobTest,
    ::testing::Values(BadJob{"", "a number and what to do"}, BadJob{"1", "a number and what to do"},
                      BadJob{"one any", "whole number in 0 to 65535"},
                      BadJob{"65536 any", "0 to 65535"}, BadJob{"-1 any", "0 to 65535"},
                      BadJob{"1 objekt=mug", "object="}, BadJob{"1 primary=both", "grasp, object"},
                      BadJob{"1 limit=0s", "500ms"}, BadJob{"1 limit=11m", "up to 10m"},
                      BadJob{"1 limit=fast", "500ms"}, BadJob{"1 min-score=1.5", "0 to 1"},
                      BadJob{"1 min-score=nan", "0 to 1"}, BadJob{"1 poses=0", "1 to 10000"},
                      BadJob{"1 outcome=lost", "picked, missed, slipped"},
                      BadJob{"1 object=", "its id"},
                      BadJob{"1 object=mug label=cups", "two different jobs"},
                      BadJob{"1 show=top outcome=picked", "two different jobs"},
                      BadJob{"1 object=mug object=cup", "twice"}));

TEST(ParseJobs, DuplicateNumbersAreRejected) {
  EXPECT_THAT(ParseJobs({"1 any", "1 label=x"}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("number 1 is taken")));
  const auto jobs = ParseJobs({"1 any", "2 label=x"});
  ASSERT_THAT(jobs, IsOk());
  EXPECT_EQ(jobs->at(2).label, "x");
}

}  // namespace
}  // namespace graspdb::client
