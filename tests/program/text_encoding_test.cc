#include "program/text/text_encoding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace graspdb {
namespace {

using ::testing::HasSubstr;

std::string Wide(const std::string& text, bool is_big_endian) {
  std::string out;
  for (const char c : text) {
    if (is_big_endian) out += '\0';
    out += c;
    if (!is_big_endian) out += '\0';
  }
  return out;
}

TEST(TextEncoding, AByteOrderMarkIsRemoved) {
  for (const std::string text : {"", "{}", "\xC3\xA9t\xC3\xA9", "\xEF\xBB", "a\xEF\xBB\xBF"}) {
    for (const char* mark : {"", "\xEF\xBB\xBF"}) {
      std::string read = mark + text;
      ASSERT_TRUE(TakeUtf8("a.json", &read).ok());
      EXPECT_EQ(read, text);
    }
  }
}

TEST(TextEncoding, Utf16IsAnErrorWithItsNameAndAdvice) {
  const std::string text = "{\"a\": 1}";
  for (std::string read : {"\xFF\xFE" + Wide(text, false), "\xFE\xFF" + Wide(text, true),
                           Wide(text, false), Wide(text, true)}) {
    const absl::Status status = TakeUtf8("folder/a.json", &read);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    const std::string message(status.message());
    EXPECT_THAT(message, HasSubstr("folder/a.json has the encoding UTF-16"));
    EXPECT_THAT(message, HasSubstr("; save it with the encoding UTF-8"));
  }
}

}  // namespace
}  // namespace graspdb
