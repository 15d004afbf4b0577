#include "program/log/request_id.h"

#include <gtest/gtest.h>

#include <string>

namespace graspdb {
namespace {

TEST(RequestId, TextThatNeedsNoQuotesIsTaken) {
  EXPECT_TRUE(IsRequestId("7f3c-A_b.9"));
  EXPECT_TRUE(IsRequestId(std::string(64, 'a')));
  EXPECT_FALSE(IsRequestId(""));
  EXPECT_FALSE(IsRequestId(std::string(65, 'a')));
  EXPECT_FALSE(IsRequestId("a b"));
  EXPECT_FALSE(IsRequestId("a\nlevel=error"));
  EXPECT_FALSE(IsRequestId("\xc3\xa4"));
}

TEST(RequestId, NewOnesDiffer) {
  EXPECT_TRUE(IsRequestId(MakeRequestId()));
  EXPECT_NE(MakeRequestId(), MakeRequestId());
}

}  // namespace
}  // namespace graspdb
