// The line protocol.
#include "client/cell/robots/line/line_protocol.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "tests/client/cell/robots/line_protocol_fixture.h"

namespace graspdb::client {
namespace {

using recognition::Pose;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Pair;
using ::testing::StartsWith;

TEST_F(LineProtocolTest, ACompletePickFromFormatToOutcome) {
  EXPECT_EQ(Call("STATUS"), "OK 1\n");
  EXPECT_EQ(Call("FORMAT STAUBLI"), "OK 4\n");
  EXPECT_EQ(Call("RUN 7"), "OK 1 1 500.000 -200.000 12.500 180.0000 0.0000 -30.0000 0.0000\n");
  EXPECT_EQ(Call("GRASP 7"),
            "OK 100.000 50.000 40.000 0.9300 objects/bracket objects/bracket/stablePoses/flat "
            "side\n");
  EXPECT_EQ(Call("RELATED 7"), "OK 1 0 600.000 -200.000 12.500 180.0000 0.0000 -30.0000 0.0000\n");
  EXPECT_THAT(Call("RELATED 7"), StartsWith("ERR 2 NO_RELATED_POSES: "));
  EXPECT_EQ(Call("STATE 7"), "OK 3 DONE\n");
  EXPECT_EQ(Call("MISSED"), "OK\n");
  EXPECT_THAT(Call("NEXT 7"), StartsWith("OK 0 0 550.000 "));
  EXPECT_EQ(Call("picked"), "OK\n");
  EXPECT_THAT(Call("NEXT 7"), StartsWith("ERR 1 NO_POSES_FOUND: "));
  EXPECT_EQ(Call("STATE 7"), "OK 1 INACTIVE\n");
  EXPECT_THAT(runner_.outcomes(), ElementsAre(Pair("r/side", PickOutcome::kMissed),
                                              Pair("r/top", PickOutcome::kPicked)));
}

TEST_F(LineProtocolTest, ARelatedGraspHasItsOwnDetailsAndOutcome) {
  JobPose object = Grasp(0.5, "side");  // an object, which is given with its first grasp
  object.base_related = {Down(0.6), Down(0.7)};
  object.related_grasps.assign(2, object.grasp);
  v1::Grasp& top = object.related_grasps[1];
  top.set_grasp_id("top");
  top.set_gripper_opening_m(0.08);
  top.set_approach_distance_m(0.2);
  top.set_retreat_distance_m(0.15);
  runner_.Set(7, std::vector<JobPose>{object});
  Call("FORMAT 4");
  ASSERT_THAT(Call("RUN 7"), StartsWith("OK 0 2 500.000 "));
  ASSERT_THAT(Call("RELATED 7"), StartsWith("OK 0 1 600.000 "));
  EXPECT_THAT(Call("GRASP 7"), AllOf(StartsWith("OK 100.000 50.000 40.000 "), EndsWith(" side\n")));
  ASSERT_THAT(Call("RELATED 7"), StartsWith("OK 0 0 700.000 "));
  EXPECT_THAT(Call("GRASP 7"), AllOf(StartsWith("OK 200.000 150.000 80.000 "), EndsWith(" top\n")));
  EXPECT_EQ(Call("MISSED"), "OK\n");
  EXPECT_THAT(runner_.outcomes(), ElementsAre(Pair("r/top", PickOutcome::kMissed)));
}

TEST_F(LineProtocolTest, TheRelatedObjectOfAGraspNeedsNoOutcome) {
  Call("FORMAT 4");
  ASSERT_THAT(Call("RUN 7"), StartsWith("OK 1 1 "));
  EXPECT_EQ(Call("PICKED"), "OK\n");
  ASSERT_THAT(Call("RELATED 7"), StartsWith("OK 1 0 "));
  EXPECT_THAT(Call("PICKED"), StartsWith("ERR -6 "));
}

TEST_F(LineProtocolTest, EveryVendorGetsItsOwnConvention) {
  EXPECT_THAT(Call("FORMAT KUKA RUN 7"), EndsWith(" 12.500 30.0000 0.0000 180.0000 0.0000\n"));
  EXPECT_THAT(Call("FORMAT FANUC RUN 7"), EndsWith(" 12.500 180.0000 0.0000 30.0000 0.0000\n"));
  // Half a turn has two signs, a quarter has one.
  JobPose quarter = Grasp(0.5, "side");
  quarter.base_primary.linear() =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  runner_.Set(7, std::vector<JobPose>{quarter});
  EXPECT_THAT(Call("FORMAT ABB RUN 7"), EndsWith(" 12.500 0.707107 0.000000 0.707107 0.000000\n"));
  EXPECT_THAT(Call("FORMAT UR RUN 7"), EndsWith(" 12.500 0.000000 1.570796 0.000000 0.000000\n"));
  EXPECT_THAT(Call("RUN 7"), HasSubstr("FORMAT STAUBLI")) << "they were for one line each";
}

TEST_F(LineProtocolTest, WithoutAFormatNoPoseIsTaken) {
  EXPECT_THAT(Call("RUN 7"), StartsWith("ERR -6 INVALID_REQUEST_ERROR: "));
  EXPECT_EQ(Call("STATE 7"), "OK 1 INACTIVE\n");
  LineProtocol configured(runner_, {.pose_format = 24});
  EXPECT_THAT(configured.Answer("r", "RUN 7\n").bytes, StartsWith("OK 1 1 500.000 "));
}

TEST_F(LineProtocolTest, TheRobotsPoseReachesTheJob) {
  EXPECT_THAT(Call("FORMAT STAUBLI RUN 7 500 -200 12.5 180 0 -30"), StartsWith("OK"));
  ASSERT_TRUE(runner_.base_flange());
  EXPECT_TRUE(runner_.base_flange()->isApprox(Down(0.5), 1e-9));
}

TEST_F(LineProtocolTest, AJobMayBeStartedAndPolled) {
  EXPECT_EQ(Call("START 7"), "OK\n");
  while (Call("STATE 7") == "OK 2 RUNNING\n") std::this_thread::yield();
  EXPECT_EQ(Call("STATE 7"), "OK 3 DONE\n");
  EXPECT_THAT(Call("GRASP 7"), StartsWith("ERR 1 ")) << "none was given yet";
  EXPECT_THAT(Call("FORMAT 4 NEXT 7"), StartsWith("OK 1 1 500.000 "));
}

TEST_F(LineProtocolTest, ErrorsHaveTheNumbersOfTheGenericRobotInterface) {
  runner_.Refuse(10, absl::FailedPreconditionError("job 10 names no object"));
  runner_.Refuse(11, absl::PermissionDeniedError("job 11 is for GRI"));
  Call("FORMAT 4");
  EXPECT_THAT(Call("RUN 6"), StartsWith("ERR -12 JOB_DOES_NOT_EXIST: "));
  EXPECT_THAT(Call("RUN 8"), StartsWith("ERR 1 NO_POSES_FOUND: "));
  EXPECT_EQ(Call("RUN 9"), "ERR -3 API_NOT_REACHABLE: the server is gone\n");
  EXPECT_EQ(Call("STATE 9"), "OK 4 FAILED\n");
  EXPECT_EQ(Call("STATE 10"), "ERR -13 MISCONFIGURED_JOB: job 10 names no object\n");
  EXPECT_THAT(Call("START 11"), StartsWith("ERR -11 WRONG_PROTOCOL_FOR_JOB: "));
  EXPECT_THAT(Call("JUMP"), StartsWith("ERR -8 INVALID_ACTION: "));
  EXPECT_THAT(Call("RUN seven"), StartsWith("ERR -6 INVALID_REQUEST_ERROR: "));
  EXPECT_THAT(Call(""), StartsWith("ERR -6 INVALID_REQUEST_ERROR: "));
  runner_.SetReady(false);
  EXPECT_EQ(Call("STATUS"), "OK 0\n");
}

TEST_F(LineProtocolTest, RobotsDoNotSeeEachOthersResults) {
  Call("FORMAT STAUBLI", "left");
  ASSERT_THAT(Call("RUN 7", "left"), StartsWith("OK 1 1 "));
  EXPECT_THAT(Call("NEXT 7", "right"), StartsWith("ERR -6 ")) << "it has no format";
  EXPECT_THAT(Call("FORMAT UR NEXT 7", "right"), StartsWith("ERR 1 NO_POSES_FOUND: "));
  EXPECT_THAT(Call("FORMAT UR RELATED 7", "right"), StartsWith("ERR 2 NO_RELATED_POSES: "));
  EXPECT_THAT(Call("GRASP 7", "right"), StartsWith("ERR 1 NO_POSES_FOUND: "));
  EXPECT_EQ(Call("STATE 7", "right"), "OK 1 INACTIVE\n");
  EXPECT_THAT(Call("NEXT 7", "left"), StartsWith("OK 0 0 550.000 "));
}

TEST_F(LineProtocolTest, AfterRequestsOfManyRobotsARobotIsLikeANewOne) {
  Call("FORMAT STAUBLI");
  ASSERT_THAT(Call("RUN 7"), StartsWith("OK 1 1 "));
  for (std::size_t i = 0; i < kMaxSessions; ++i) Call("STATE 7", absl::StrCat(i));
  EXPECT_EQ(Call("STATE 7"), "OK 1 INACTIVE\n");
  EXPECT_THAT(Call("PICKED"), StartsWith("ERR -6 "));
  EXPECT_THAT(Call("RUN 7"), HasSubstr("FORMAT STAUBLI"));
  EXPECT_THAT(Call("FORMAT STAUBLI RUN 7"), StartsWith("OK 1 1 500.000 "));
}

TEST_F(LineProtocolTest, AnOutcomeWithoutAPoseIsRejected) {
  EXPECT_THAT(Call("PICKED"), StartsWith("ERR -6 INVALID_REQUEST_ERROR: no pose was given"));
  Call("FORMAT 4 RUN 7");
  EXPECT_EQ(Call("SLIPPED"), "OK\n");
  EXPECT_THAT(Call("SLIPPED"), StartsWith("ERR -6 "));
  EXPECT_THAT(Call("PICKED", "another"), StartsWith("ERR -6 "));
}

TEST_F(LineProtocolTest, AnOutOfRangePoseIsAnErrorAndTheNextOneIsReturned) {
  for (const double x : {100.001, -1e6, std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::infinity()}) {
    runner_.Set(7, std::vector<JobPose>{Grasp(x, "far"), Grasp(0.5, "near")});
    EXPECT_THAT(Call("FORMAT 4 RUN 7"), StartsWith("ERR -4 API_RESPONSE_ERROR: ")) << x;
    EXPECT_THAT(Call("PICKED"), StartsWith("ERR -6 "));
    EXPECT_THAT(Call("GRASP 7"), StartsWith("ERR 1 "));
    EXPECT_THAT(Call("FORMAT 4 RELATED 7"), StartsWith("ERR 2 "));
    EXPECT_THAT(Call("FORMAT 4 NEXT 7"), StartsWith("OK 0 0 500.000 "));
    EXPECT_EQ(Call("PICKED"), "OK\n");
  }
}

TEST_F(LineProtocolTest, RepliesAreOneLineOfLimitedLength) {
  runner_.Set(7, absl::InternalError(std::string(1000, 'x') + "\nsecond\r line"));
  const std::string reply = Call("FORMAT 4 RUN 7");
  EXPECT_EQ(reply.size(), kMaxReplyBytes);
  EXPECT_EQ(reply.find('\n'), reply.size() - 1);
  EXPECT_LE(Call("HELP").size(), kMaxReplyBytes);
  runner_.Set(7, absl::InternalError("two\nlines\x80"));
  EXPECT_EQ(Call("FORMAT 4 RUN 7"), "ERR -2 INTERNAL_ERROR: two lines \n");
}

TEST_F(LineProtocolTest, AcceptsBothLineEnds) {
  EXPECT_EQ(protocol_.Answer("r", "STATUS\r\n").bytes, "OK 1\n");
  EXPECT_EQ(protocol_.MessageBytes("STATUS\r\nSTATUS"), 8U);
  EXPECT_EQ(protocol_.MessageBytes("STATUS"), 0U);
}

TEST_F(LineProtocolTest, PosesSurviveARoundTrip) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  for (int format = 1; format <= 51; ++format) {
    JobPose found;
    const Eigen::Vector4d q(normal(random), normal(random), normal(random), normal(random));
    found.base_primary.linear() = Eigen::Quaterniond(q).normalized().toRotationMatrix();
    found.base_primary.translation() << normal(random), normal(random), normal(random);
    runner_.Set(7, std::vector<JobPose>{found});
    const std::string name = "FORMAT " + std::to_string(format);
    std::istringstream reply(Call(name + " RUN 7"));
    std::string ok;
    int primaries = -1;
    int related = -1;
    std::string numbers;
    reply >> ok >> primaries >> related;
    std::getline(reply, numbers);
    ASSERT_EQ(ok, "OK");
    ASSERT_THAT(Call(absl::StrCat(name, " RUN 7", numbers)), StartsWith("OK"));
    const Pose back = *runner_.base_flange();
    EXPECT_LT((back.translation() - found.base_primary.translation()).norm(), 1e-6);
    EXPECT_LT((back.linear() - found.base_primary.linear()).norm(), 5e-6) << format;
  }
}

}  // namespace
}  // namespace graspdb::client
