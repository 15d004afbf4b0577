#include <gmock/gmock.h>

#include "server/base/errors.h"

namespace graspdb::server {
namespace {

TEST(BoundedText, ShortTextIsUnchanged) {
  EXPECT_EQ(BoundedText("", 3), "");
  EXPECT_EQ(BoundedText("abc", 3), "abc");
  EXPECT_EQ(BoundedText("a\u00e4\u20ac\U0001f980", 10), "a\u00e4\u20ac\U0001f980");
}

TEST(BoundedText, LongTextIsCutBetweenCharactersWithDots) {
  EXPECT_EQ(BoundedText("abcd", 3), "...");
  EXPECT_EQ(BoundedText("abcdefgh", 7), "abcd...");
  EXPECT_EQ(BoundedText("ab\u20ac\u20ac\u20ac", 7), "ab...");
  EXPECT_EQ(BoundedText("ab\u20ac\u20ac\u20ac", 8), "ab\u20ac...");
}

TEST(BoundedText, InvalidUtf8IsReplacedByteByByte) {
  EXPECT_EQ(BoundedText("a\xff"
                        "b",
                        9),
            "a?b");
  EXPECT_EQ(BoundedText("a\xe2\x82", 9), "a??") << "truncated";
  EXPECT_EQ(BoundedText("\xc0\xaf", 9), "??") << "overlong";
  EXPECT_EQ(BoundedText("\xe0\x80\xaf", 9), "???") << "overlong";
  EXPECT_EQ(BoundedText("\xed\xa0\x80", 9), "???") << "a surrogate";
  EXPECT_EQ(BoundedText("\xf4\x90\x80\x80", 9), "????") << "beyond the last character";
}

}  // namespace
}  // namespace graspdb::server
