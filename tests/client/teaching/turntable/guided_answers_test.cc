#include <gmock/gmock.h>

#include "client/teaching/upload/view_upload.h"
#include "tests/client/teaching/turntable/guided_teaching_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using ::testing::Contains;
using ::testing::HasSubstr;

using GuidedAnswersTest = GuidedTeachingTest;

TEST_F(GuidedAnswersTest, BlanksAroundAnAnswerAreIgnored) {
  Person person(table_);
  person.Answers(" side ").Answers(" q ");
  const auto counts = Teach(person);
  ASSERT_THAT(counts, IsOk());
  EXPECT_TRUE(counts->stopped);
  EXPECT_TRUE(person.IsDone());
  EXPECT_EQ(person.prompts().size(), 2U) << "it prompted again";
}

// Three views about the axis, and one of them once more about another one.
class HalfMovedTurnTest : public GuidedTeachingTest {
 protected:
  void SetUp() override {
    GuidedTeachingTest::SetUp();
    options_.step_deg = 120;
    Person person(table_);
    person.Answers("").Answers("").Answers("", 3).Answers("done");
    ASSERT_THAT(Teach(person), IsOk());
    const auto views = client_.ListViews(kStablePose);
    ASSERT_THAT(views, IsOk());
    ASSERT_EQ(views->size(), 3U);
    const auto view = client_.GetView(views->front().name());
    ASSERT_THAT(view, IsOk());
    const auto make = [&](std::size_t, v1::UploadViewsRequest* request) {
      request->set_parent(kStablePose);
      request->set_view_id("moved");
      *request->mutable_view() = *view;
      request->mutable_view()->set_segmented(true);
      request->mutable_view()->mutable_object_pose()->mutable_position()->set_x(kOtherX);
      return absl::OkStatus();
    };
    ASSERT_THAT(TeachViews(client_, {.count = 1, .make = make}, {}), IsOk());
    ASSERT_EQ(ViewCount(), 4U);
  }

  static constexpr char kStablePose[] = "objects/bracket-right/stablePoses/pose-1";
  static constexpr double kOtherX = 0.2;
};

TEST_F(HalfMovedTurnTest, ViewsAboutTheOtherAxisAreDeletedAfterConfirmation) {
  Person person(table_);
  person.Answers("").Answers("y").Answers("done");
  ASSERT_THAT(Teach(person), IsOk());
  EXPECT_THAT(person.prompts().at(0), HasSubstr("Enter: pose-1"));
  EXPECT_THAT(person.printed(), Contains(HasSubstr("0.2000,-0.0300")));
  EXPECT_TRUE(person.IsDone());
  const auto views = client_.ListViews(kStablePose);
  ASSERT_THAT(views, IsOk());
  ASSERT_EQ(views->size(), 3U);
  for (const v1::View& view : *views) {
    EXPECT_NEAR(view.object_pose().position().x(), Axis().x(), 1e-9);
  }
}

TEST_F(HalfMovedTurnTest, ViewsAboutTheOtherAxisStayWithoutConfirmation) {
  Person person(table_);
  person.Answers("").Answers("").Answers("done");
  ASSERT_THAT(Teach(person), IsOk());
  EXPECT_THAT(person.prompts().back(), HasSubstr("Enter: pose-2"));
  EXPECT_TRUE(person.IsDone());
  EXPECT_EQ(ViewCount(), 4U);
}

}  // namespace
}  // namespace graspdb::client
