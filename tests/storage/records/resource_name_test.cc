#include "storage/records/resource_name.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace graspdb::storage {
namespace {

using ::testing::HasSubstr;

TEST(ResourceIdTest, AcceptsLettersDigitsAndThreeSigns) {
  for (const std::string id : {"a", "0", "mustard", "006_mustard_bottle", "A.b-C_9", "X"}) {
    EXPECT_TRUE(ValidateResourceId(id).ok()) << id;
  }
  EXPECT_TRUE(ValidateResourceId(std::string(63, 'a')).ok());
}

TEST(ResourceIdTest, RejectsOtherCharacters) {
  for (const std::string id : {"", "-a", ".", "..", "_a", "a/b", "a b", "a\n", "\xc3\xa4", "a:b"}) {
    EXPECT_EQ(ValidateResourceId(id).code(), absl::StatusCode::kInvalidArgument) << id;
  }
  EXPECT_FALSE(ValidateResourceId(std::string(64, 'a')).ok());
  EXPECT_FALSE(ValidateResourceId(std::string("a\0b", 3)).ok());
}

TEST(ResourceNameTest, ParsesMadeNames) {
  const auto object = ParseObjectName(MakeObjectName("mug"));
  ASSERT_TRUE(object.ok());
  EXPECT_EQ(object->object_id, "mug");

  const auto pose = ParseStablePoseName(MakeStablePoseName("mug", "upright"));
  ASSERT_TRUE(pose.ok());
  EXPECT_EQ(pose->object_id, "mug");
  EXPECT_EQ(pose->stable_pose_id, "upright");

  const auto view = ParseViewName(MakeViewName("mug", "upright", "az-015"));
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(view->object_id, "mug");
  EXPECT_EQ(view->stable_pose_id, "upright");
  EXPECT_EQ(view->view_id, "az-015");

  EXPECT_TRUE(CheckCellName(MakeCellName("line-1")).ok());
}

TEST(ResourceNameTest, NamesOfOneKindAreNotOfAnother) {
  EXPECT_FALSE(ParseObjectName("cells/a").ok());
  EXPECT_FALSE(CheckCellName("objects/a").ok());
  EXPECT_FALSE(ParseObjectName("objects/a/stablePoses/b").ok());
  EXPECT_FALSE(ParseStablePoseName("objects/a").ok());
  EXPECT_FALSE(ParseViewName("objects/a/stablePoses/b").ok());
  EXPECT_FALSE(ParseStablePoseName("objects/a/stablePoses/b/views/c").ok());
}

TEST(ResourceNameTest, RejectsNearMisses) {
  for (const std::string name :
       {"", "objects", "objects/", "objects//", "/objects/a", "objects/a/", "Objects/a", "objectsa",
        "objects/a/stablePoses", "objects/a b", "objects/..", "objects/a%2fb"}) {
    EXPECT_EQ(ParseObjectName(name).status().code(), absl::StatusCode::kInvalidArgument) << name;
  }
  EXPECT_FALSE(ParseStablePoseName("objects/a/stableposes/b").ok());
  EXPECT_FALSE(ParseStablePoseName("objects//stablePoses/b").ok());
  EXPECT_FALSE(ParseViewName("objects/a/stablePoses/b/views/").ok());
}

TEST(ResourceNameTest, ErrorHasTheNameAndTheRule) {
  const std::string message(ParseStablePoseName("objects/mug\x1b[31m").status().message());
  EXPECT_THAT(message, HasSubstr("\"objects/mug?[31m\""));
  EXPECT_THAT(message, HasSubstr("objects/{object}/stablePoses/{stable_pose}"));
  const std::string long_message(ParseObjectName(std::string(100'000, 'x')).status().message());
  EXPECT_LT(long_message.size(), 400U);
}

}  // namespace
}  // namespace graspdb::storage
