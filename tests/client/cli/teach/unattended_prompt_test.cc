// Teaching with nobody at the terminal.
#include "client/cli/teach/unattended_prompt.h"

#include <gmock/gmock.h>

#include <vector>

#include "absl/time/clock.h"

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
  void Say(const std::string& text) override { said.push_back(text); }
  std::optional<std::string> Ask(const std::string& question) override {
    asked.push_back(question);
    return "me";
  }

  std::vector<std::string> said;
  std::vector<std::string> asked;
};

TEST(UnattendedPrompt, YesTeachesOneStablePoseAndAsksNobody) {
  Person person;
  UnattendedPrompt prompt(person, {.yes = true});
  for (const char* question : {kStablePose, kSymmetry, kFirstView, kNextView}) {
    EXPECT_THAT(prompt.Ask(question), Optional(std::string()));
  }
  EXPECT_THAT(prompt.Ask(kStablePose), Optional(std::string("done")));
  EXPECT_THAT(person.asked, IsEmpty());
  EXPECT_EQ(person.said.size(), 5U) << "what is answered is told";
}

TEST(UnattendedPrompt, AViewThatFailsThreeTimesIsTheEnd) {
  Person person;
  UnattendedPrompt prompt(person, {.yes = true});
  EXPECT_THAT(prompt.Ask(kFirstView), Optional(std::string()));
  for (int i = 0; i < 3; ++i) EXPECT_THAT(prompt.Ask(kNextView), Optional(std::string()));
  EXPECT_EQ(prompt.Ask(kNextView), std::nullopt);
}

TEST(UnattendedPrompt, SettlingWaitsBeforeViewsAndLeavesTheRestToThePerson) {
  Person person;
  UnattendedPrompt prompt(person, {.settle = absl::Milliseconds(30)});
  EXPECT_THAT(prompt.Ask(kStablePose), Optional(std::string("me")));
  const absl::Time before = absl::Now();
  EXPECT_THAT(prompt.Ask(kFirstView), Optional(std::string()));
  EXPECT_GE(absl::Now() - before, absl::Milliseconds(30));
  EXPECT_THAT(person.asked, ElementsAre(kStablePose));
}

TEST(UnattendedPrompt, WithoutEitherThePersonIsAsked) {
  Person person;
  UnattendedPrompt prompt(person, {});
  EXPECT_THAT(prompt.Ask(kFirstView), Optional(std::string("me")));
  prompt.Say("so it is");
  EXPECT_THAT(person.said, ElementsAre("so it is"));
}

}  // namespace
}  // namespace graspdb::client
