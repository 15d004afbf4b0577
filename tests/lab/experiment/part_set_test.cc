#include "lab/experiment/trials/part_set.h"

#include <gmock/gmock.h>

#include "tests/testing/status_matchers.h"

namespace graspdb::lab {
namespace {

using testing::IsOk;
using testing::StatusIs;

std::vector<std::string> Objects(const PartSet& set) {
  std::vector<std::string> out;
  for (const rendering::Workpiece& part : set.parts) out.push_back(part.object_id);
  return out;
}

class ChooseTest : public ::testing::Test {
 protected:
  // Of these a shaft and a nut are round.
  static const PartSet& All() {
    static const PartSet all = TwinParts();
    return all;
  }
};

TEST_F(ChooseTest, ExcludesRoundObjectsFromTheMainCases) {
  const auto main = Choose(All(), PartChoice::kMain, {});
  const auto round = Choose(All(), PartChoice::kRound, {});
  ASSERT_THAT(main, IsOk());
  ASSERT_THAT(round, IsOk());
  EXPECT_EQ(main->parts.size() + round->parts.size(), All().parts.size());
  EXPECT_THAT(Objects(*round), ::testing::Contains("stepped-shaft"));
  EXPECT_EQ(main->taught_count, main->parts.size());
}

TEST_F(ChooseTest, ShowsUnknownObjectsWithoutTeachingThem) {
  const auto set = Choose(All(), PartChoice::kStrangers, {.main = {"flange", "handle"}});
  ASSERT_THAT(set, IsOk());
  EXPECT_EQ(set->taught_count, 2U);
  EXPECT_EQ(set->parts.size(), All().parts.size());
  EXPECT_EQ(set->shapes.size(), set->parts.size());
}

TEST_F(ChooseTest, RejectsAnUnknownName) {
  EXPECT_THAT(Choose(All(), PartChoice::kMain, {.main = {"teapot"}}),
              StatusIs(absl::StatusCode::kInvalidArgument));
}

// As of two datasets that number their models: all but one were left out.
TEST(RestingParts, RejectsTwoFilesOfOneObject) {
  EXPECT_THAT(RestingParts({"lm/obj_1.ply", "ycbv/OBJ_1.stl"}, 1, {}),
              StatusIs(absl::StatusCode::kInvalidArgument, ::testing::HasSubstr("rename one")));
}

}  // namespace
}  // namespace graspdb::lab
