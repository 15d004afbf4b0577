#include "program/text/printable_text.h"

#include <gtest/gtest.h>

namespace graspdb {
namespace {

TEST(PrintableText, ValidTextIsUnchanged) {
  for (const char* text : {"", "mug", "St\u00e4ubli", "\u20ac\u30b3\U0001f980", "\u00a0", "~"}) {
    EXPECT_EQ(PrintableText(text), text);
  }
}

TEST(PrintableText, ControlCharactersAreReplaced) {
  EXPECT_EQ(PrintableText("\x1b[31mred\x1b[0m\r\n\t\x7f"), "?[31mred?[0m????");
  EXPECT_EQ(PrintableText("\xc2\x80 \xc2\x9b\xc2\x9f "), "? ?? ");
  EXPECT_EQ(PrintableText(std::string(1, '\0')), "?");
}

TEST(PrintableText, OverridesAndIsolatesOfTheDirectionAreReplaced) {
  EXPECT_EQ(PrintableText("\u202aa\u202eb\u2066c\u2069d"), "?a?b?c?d");
  EXPECT_EQ(PrintableText("\u2029\u202f\u2065\u206a"), "\u2029\u202f\u2065\u206a");
}

TEST(PrintableText, InvalidUtf8IsReplacedByteByByte) {
  EXPECT_EQ(PrintableText("a\xff\xe2\x82"), "a???");
  EXPECT_EQ(PrintableText("\xc2\x1b"), "??");
}

}  // namespace
}  // namespace graspdb
