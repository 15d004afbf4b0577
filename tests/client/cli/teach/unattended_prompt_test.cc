// Unattended teaching.
#include <gmock/gmock.h>

#include <vector>

#include "client/cli/teach/guided_teach.h"
#include "program/base/monotonic_time.h"

namespace graspdb::client {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Optional;

constexpr char kStablePose[] = "id of the stable pose (Enter: pose-1, done: that was all) ";
constexpr char kSymmetry[] = "after which turns about the vertical does it look the same? ";
constexpr char kFirstView[] = "turn the object to 0 degrees and press Enter ";
constexpr char kNextView[] = "turn the object to 20 degrees and press Enter ";

// A person who answers "me".
class Person : public TeachingPrompt {
 public:
  void Print(const std::string& text) override { printed.push_back(text); }
  std::optional<std::string> ReadLine(const std::string& question) override {
    prompts.push_back(question);
    return "me";
  }

  std::vector<std::string> printed;
  std::vector<std::string> prompts;
};

TEST(UnattendedPrompt, YesTeachesOneStablePoseWithoutPrompts) {
  Person person;
  UnattendedPrompt prompt(person, {.yes = true});
  for (const char* question : {kStablePose, kSymmetry, kFirstView, kNextView}) {
    EXPECT_THAT(prompt.ReadLine(question), Optional(std::string()));
  }
  EXPECT_THAT(prompt.ReadLine(kStablePose), Optional(std::string("done")));
  EXPECT_THAT(person.prompts, IsEmpty());
  EXPECT_EQ(person.printed.size(), 5U) << "answered prompts are printed";
}

TEST(UnattendedPrompt, AViewThatFailsThreeTimesEndsTeaching) {
  Person person;
  UnattendedPrompt prompt(person, {.yes = true});
  EXPECT_THAT(prompt.ReadLine(kFirstView), Optional(std::string()));
  for (int i = 0; i < 3; ++i) EXPECT_THAT(prompt.ReadLine(kNextView), Optional(std::string()));
  EXPECT_EQ(prompt.ReadLine(kNextView), std::nullopt);
}

TEST(UnattendedPrompt, SettleWaitsBeforeViewsAndForwardsOtherPrompts) {
  Person person;
  UnattendedPrompt prompt(person, {.settle = absl::Milliseconds(30)});
  EXPECT_THAT(prompt.ReadLine(kStablePose), Optional(std::string("me")));
  const MonotonicTime before = MonotonicTime::Now();
  EXPECT_THAT(prompt.ReadLine(kFirstView), Optional(std::string()));
  EXPECT_GE(MonotonicTime::Now() - before, absl::Milliseconds(30));
  EXPECT_THAT(person.prompts, ElementsAre(kStablePose));
}

TEST(UnattendedPrompt, WithoutEitherThePersonIsPrompted) {
  Person person;
  UnattendedPrompt prompt(person, {});
  EXPECT_THAT(prompt.ReadLine(kFirstView), Optional(std::string("me")));
  prompt.Print("a note");
  EXPECT_THAT(person.printed, ElementsAre("a note"));
}

}  // namespace
}  // namespace graspdb::client
