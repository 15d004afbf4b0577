#include "client/teaching/turntable/guided_teaching.h"

#include <gmock/gmock.h>

#include "tests/client/teaching/turntable/guided_teaching_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

TEST_F(GuidedTeachingTest, ATaughtTurnIsRecognisedAtAnotherAzimuth) {
  Person person(table_);
  person.Answers("").Answers("").Answers("", 18).Answers("done");
  const auto counts = Teach(person);
  ASSERT_THAT(counts, IsOk());
  EXPECT_TRUE(person.IsDone());
  EXPECT_EQ(counts->taught, 18);
  EXPECT_FALSE(counts->stopped);
  EXPECT_EQ(ViewCount(), 18U);
  EXPECT_THAT(person.printed(), Not(Contains(HasSubstr("note: the views fit"))));
  EXPECT_THAT(person.printed(), Contains(HasSubstr("[##################]  taught 18 of 18")));
  EXPECT_THAT(person.printed(), Contains(AllOf(HasSubstr("40 degrees: "), HasSubstr(" points"),
                                               HasSubstr("of its outline measured"))));

  ExpectRecognisedAt(130);
}

TEST_F(GuidedTeachingTest, ViewsAreSkippedAndRepeatedAndTheRestIsTaughtTheNextTime) {
  options_.step_deg = 60;
  Person first(table_);
  // 0, not 60, 120; 120 again; then the input ends.
  first.Answers("upright").Answers("2").Answers("").Answers("s").Answers("").Answers("r").Answers(
      "");
  const auto counts = Teach(first);
  ASSERT_THAT(counts, IsOk());
  EXPECT_EQ(counts->taught, 3);
  EXPECT_TRUE(counts->stopped);
  EXPECT_EQ(ViewCount("upright"), 2U);  // the repeated one took the place of the other
  EXPECT_THAT(first.prompts().at(6), HasSubstr("to 120 degrees"));
  EXPECT_THAT(first.printed(), Contains(HasSubstr("missing: 60, 180 to 300 degrees")));
  const auto pose = client_.GetStablePose("objects/bracket-right/stablePoses/upright");
  ASSERT_THAT(pose, IsOk());
  EXPECT_EQ(pose->symmetry_order(), 2);

  Person second(table_);
  second.Answers("").Answers("", 4).Answers("done");
  const auto rest = Teach(second);
  ASSERT_THAT(rest, IsOk());
  EXPECT_THAT(second.prompts().at(0), HasSubstr("Enter: upright"));
  EXPECT_THAT(second.prompts().at(1), HasSubstr("to 60 degrees"));
  EXPECT_EQ(rest->taught, 4);
  EXPECT_EQ(ViewCount("upright"), 6U);
  EXPECT_THAT(second.prompts().back(), HasSubstr("Enter: pose-1"));
}

TEST_F(GuidedTeachingTest, AnEmptyTableAndAFrozenCameraAreReportedAndNotTaught) {
  options_.step_deg = 120;
  Person person(table_);
  person.Answers("").Answers("");
  person.Does([&] { table_.is_empty = true; });
  person.Does([&] { table_.is_empty = false, table_.is_frozen = true; });
  person.Does([&] { table_.turned_deg = 0; });  // the prompt requests 120, but nothing moves
  person.Answers("q");
  const auto counts = Teach(person);
  ASSERT_THAT(counts, IsOk());
  EXPECT_TRUE(counts->stopped);
  EXPECT_EQ(counts->taught, 1);
  EXPECT_EQ(ViewCount(), 1U);
  EXPECT_THAT(person.printed(), Contains(HasSubstr("not taught: ")).Times(2));
  EXPECT_THAT(person.printed(), Contains(HasSubstr("nothing stands on the table")));
  EXPECT_THAT(person.printed(), Contains(HasSubstr("frozen")));
}

TEST_F(GuidedTeachingTest, AViewWithFarFewerPointsIsKeptOnlyAfterConfirmation) {
  options_.step_deg = 40;
  Person person(table_);
  person.Answers("").Answers("").Answers("");
  person.Does([&] { table_.is_hidden = true; }).Answers("");  // taken again, as hidden:
  person.Answers("").Answers("k");
  person.Answers("q");
  const auto counts = Teach(person);
  ASSERT_THAT(counts, IsOk());
  EXPECT_TRUE(person.IsDone());
  EXPECT_THAT(person.printed(), Contains(HasSubstr("where the views beside it have")).Times(2));
  EXPECT_EQ(counts->taught, 2);
  EXPECT_EQ(ViewCount(), 2U);
}

TEST_F(GuidedTeachingTest, AnUnansweredPromptEndsTeachingCleanly) {
  Person person(table_);
  EXPECT_THAT(Teach(person).value_or(GuidedCounts()).stopped, ::testing::IsTrue());
}

TEST_F(GuidedTeachingTest, InvalidAnswersArePromptedAgain) {
  Person person(table_);
  person.Answers("no id!").Answers("side").Answers("half").Answers("any");
  person.Answers("r").Answers("what").Answers("q");
  ASSERT_THAT(Teach(person), IsOk());
  EXPECT_TRUE(person.IsDone());
  EXPECT_THAT(person.printed(), Contains(HasSubstr("1 to 63 characters")));
  EXPECT_THAT(person.printed(), Contains(HasSubstr("no view to repeat")));
  EXPECT_THAT(person.printed(), Contains(HasSubstr("\"what\" is not an answer")));
  const auto pose = client_.GetStablePose("objects/bracket-right/stablePoses/side");
  ASSERT_THAT(pose, IsOk());
  EXPECT_EQ(pose->symmetry_order(), 0);
}

TEST_F(GuidedTeachingTest, AnUndeclaredSymmetryIsReportedAtOnce) {
  options_.step_deg = 30;
  ShowPart("z-bar");
  table_.beside = Eigen::Vector3d::Zero();
  Person person(table_);
  person.Answers("").Answers("", 13);  // declares no symmetry
  ASSERT_THAT(Teach(person), IsOk());
  EXPECT_THAT(person.printed(), Contains(AllOf(HasSubstr("note: "), HasSubstr("half a turn"))));
}

TEST_F(GuidedTeachingTest, ViewsAboutAnotherAxisAreNotMixedIn) {
  options_.step_deg = 120;
  Person first(table_);
  first.Answers("").Answers("").Answers("").Answers("q");
  ASSERT_THAT(Teach(first), IsOk());
  options_.axis = Axis() + Eigen::Vector2d(0.02, 0);
  Person second(table_);
  second.Answers("pose-1");
  const auto counts = Teach(second);
  ASSERT_THAT(counts, IsOk());
  EXPECT_THAT(second.prompts().front(), HasSubstr("Enter: pose-2"));
  EXPECT_THAT(second.printed(), Contains(HasSubstr("--axis")));
  EXPECT_EQ(ViewCount(), 1U);
}

TEST_F(GuidedTeachingTest, ViewsAboutAWrongAxisAreMovedToTheRightOne) {
  options_.axis = Axis() + Eigen::Vector2d(0.008, -0.009);
  Person person(table_);
  person.Answers("").Answers("", 19).Answers("").Answers("done");
  ASSERT_THAT(Teach(person), IsOk());
  EXPECT_TRUE(person.IsDone());
  EXPECT_THAT(person.printed(),
              Contains(HasSubstr("done; when you teach on this turntable again")));
  EXPECT_EQ(ViewCount(), 18U);
  ExpectRecognisedAt(130);
}

TEST_F(GuidedTeachingTest, AnObjectOnAHighPlateIsTaughtWithoutThePlate) {
  options_.step_deg = 120;
  Person person(table_);
  person.Answers("").Answers("", 4);
  ASSERT_THAT(Teach(person), IsOk());
  options_.object_id = "raised";
  options_.plate_height_m = kPlateHeightM;
  table_.has_plate = true;
  Person second(table_);
  second.Answers("").Answers("", 4);
  ASSERT_THAT(Teach(second), IsOk());
  const auto flat = client_.ListViews("objects/bracket-right/stablePoses/pose-1");
  const auto raised = client_.ListViews("objects/raised/stablePoses/pose-1");
  ASSERT_THAT(flat, IsOk());
  ASSERT_THAT(raised, IsOk());
  ASSERT_EQ(raised->size(), 3U);
  int flat_points = 0;
  int raised_points = 0;
  for (const v1::View& view : *flat) flat_points += view.point_count();
  for (const v1::View& view : *raised) {
    raised_points += view.point_count();
    EXPECT_NEAR(view.object_pose().position().z(), 0, 1e-9);
  }
  EXPECT_GT(raised_points, flat_points);  // it is nearer to the camera
  EXPECT_LT(raised_points, 1.3 * flat_points);
}

TEST_F(GuidedTeachingTest, ViewsAboutAWrongAxisStayIfTheMoveIsDeclined) {
  options_.step_deg = 40;
  options_.axis = Axis() + Eigen::Vector2d(0.008, -0.009);
  Person person(table_);
  person.Answers("").Answers("", 10).Answers("n").Answers("done");
  ASSERT_THAT(Teach(person), IsOk());
  EXPECT_TRUE(person.IsDone());
  const auto views = client_.ListViews("objects/bracket-right/stablePoses/pose-1");
  ASSERT_THAT(views, IsOk());
  ASSERT_EQ(views->size(), 9U);
  EXPECT_NEAR(views->front().object_pose().position().x(), options_.axis->x(), 1e-9);
}

TEST_F(GuidedTeachingTest, ATurnTheOtherWayIsReported) {
  options_.step_deg = 30;
  options_.clockwise = true;  // and the table turns counter-clockwise
  Person person(table_);
  person.Answers("").Answers("", 13);
  ASSERT_THAT(Teach(person), IsOk());
  EXPECT_THAT(person.printed(), Contains(HasSubstr("without --clockwise")));
}

TEST_F(GuidedTeachingTest, AMissingAxisAndAnInvalidStepAreErrorsWithAdvice) {
  Person person(table_);
  options_.step_deg = 0;
  EXPECT_THAT(Teach(person), StatusIs(absl::StatusCode::kInvalidArgument));
  options_.step_deg = 20;
  options_.cell.clear_region_of_interest();
  EXPECT_THAT(Teach(person),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("--axis X,Y")));
  EXPECT_THAT(person.prompts(), SizeIs(0));
}

}  // namespace
}  // namespace graspdb::client
