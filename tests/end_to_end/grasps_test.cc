// Grasp outcomes by the command line.
#include <gmock/gmock.h>

#include "tests/end_to_end/fixtures/outcome_matchers.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"

namespace graspdb::end_to_end {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

class GraspsTest : public ProgramsTest {
 protected:
  void SetUp() override {
    StartServer();
    Simulate("set", 120, 1);
    Succeed({"import", Path("set")});
    const std::string listed = Succeed({"grasps", "list", "flange", "--json"}).out;
    v1::StablePose pose;
    ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(FirstLine(listed), &pose).ok());
    ASSERT_FALSE(pose.grasps().empty());
    pose_ = pose.name();
    grasp_ = pose.grasps(0).grasp_id();
  }

  static std::string FirstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

  std::string pose_;
  std::string grasp_;
};

TEST_F(GraspsTest, ListsAndSumsOutcomesAlsoAfterARestart) {
  EXPECT_THAT(
      Succeed({"grasps", "list", "flange"}).out,
      AllOf(HasSubstr(pose_), ContainsRegex("picked +0 +missed +0 +slipped +0 +rate 0.90")));
  Succeed({"grasps", "report", pose_, grasp_, "picked", "--count", "7"});
  EXPECT_THAT(Succeed({"grasps", "report", pose_, grasp_, "missed"}).out,
              HasSubstr("picked 7, missed 1, slipped 0, rate 0.89"));
  server_.reset();
  StartServer();
  EXPECT_THAT(Succeed({"grasps", "list", "flange"}).out,
              ContainsRegex("picked +7 +missed +1 +slipped +0 +rate 0.89"));
  EXPECT_THAT(Succeed({"status"}).out, HasSubstr("7 picked, 1 missed, 0 slipped"));
}

TEST_F(GraspsTest, ExitsWith1ForWrongReportsAnd2ForWrongUsage) {
  const Finished none = Graspdb({"grasps", "report", pose_, "no-such-grasp", "picked"});
  EXPECT_THAT(none, EndsWith(1));
  EXPECT_THAT(none, PrintsOnly("graspdb", "no-such-grasp"));
  EXPECT_THAT(Graspdb({"grasps", "report", pose_, grasp_, "dropped"}), EndsWith(2));
  EXPECT_THAT(Graspdb({"grasps", "report", pose_, grasp_, "picked", "--count", "0"}), EndsWith(1));
}

}  // namespace
}  // namespace graspdb::end_to_end
