#include "program/log/log_field.h"

#include <gtest/gtest.h>

namespace graspdb {
namespace {

TEST(LogField, PlainValuesAreUnchanged) {
  EXPECT_EQ(LogField("ipv4:127.0.0.1:50051"), "ipv4:127.0.0.1:50051");
  EXPECT_EQ(LogField("objects/mug-2_a.b%5B[0]"), "objects/mug-2_a.b%5B[0]");
}

TEST(LogField, ValuesThatWouldEndThePairAreQuoted) {
  EXPECT_EQ(LogField(""), "\"\"");
  EXPECT_EQ(LogField("two words"), "\"two words\"");
  EXPECT_EQ(LogField("a=b"), "\"a=b\"");
}

TEST(LogField, InputCannotForgeALine) {
  EXPECT_EQ(LogField("x\ntime=0 level=info"), "\"x\\ntime=0 level=info\"");
  EXPECT_EQ(LogField("x\r\n"), "\"x\\r\\n\"");
  EXPECT_EQ(LogField("\" code=OK \\"), "\"\\\" code=OK \\\\\"");
  EXPECT_EQ(LogField(std::string("a\0b", 3)), "\"a\\000b\"");
  EXPECT_EQ(LogField("\x1b[31m"), "\"\\033[31m\"");
}

TEST(LogField, NonAsciiLettersStayReadable) { EXPECT_EQ(LogField("Größe"), "\"Größe\""); }

}  // namespace
}  // namespace graspdb
