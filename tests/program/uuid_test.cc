#include "program/base/uuid.h"

#include <gmock/gmock.h>

#include <set>

namespace graspdb {
namespace {

TEST(UuidTest, NewOnesAreValidAndDiffer) {
  std::set<std::string> made;
  std::set<char> variants;
  for (int i = 0; i < 1000; ++i) {
    const std::string id = MakeUuid4();
    EXPECT_TRUE(IsUuid4(id)) << id;
    variants.insert(id[19]);
    made.insert(id);
  }
  EXPECT_EQ(made.size(), 1000U);
  EXPECT_THAT(variants, ::testing::ElementsAre('8', '9', 'a', 'b'));
}

TEST(UuidTest, OthersAreNot) {
  EXPECT_TRUE(IsUuid4("123e4567-e89b-42d3-a456-426614174000"));
  EXPECT_TRUE(IsUuid4("123E4567-E89B-42D3-A456-426614174000"));
  for (const char* other :
       {"", "x", "123e4567-e89b-12d3-a456-426614174000", "123e4567-e89b-42d3-c456-426614174000",
        "123e4567e89b42d3a456426614174000", "123e4567-e89b-42d3-a456-42661417400",
        "123e4567-e89b-42d3-a456-4266141740000", "{123e4567-e89b-42d3-a456-426614174000}",
        "123e4567-e89b-42d3-a456-42661417400g", "123e4567+e89b-42d3-a456-426614174000"}) {
    EXPECT_FALSE(IsUuid4(other)) << other;
  }
  EXPECT_FALSE(IsUuid4(std::string(36, '\0')));
}

}  // namespace
}  // namespace graspdb
