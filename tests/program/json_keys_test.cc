#include "program/text/json_keys.h"

#include <gmock/gmock.h>

#include <string>

#include "tests/testing/status_matchers.h"

namespace graspdb {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(CheckJsonKeys, AnObjectHasAKeyOnce) {
  EXPECT_THAT(CheckJsonKeys(R"({"fx": 500, "fy": 500})"), IsOk());
  EXPECT_THAT(CheckJsonKeys("{\"fx\": 500,\n\"fy\": 500,\n \"fx\" : 50}"),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       AllOf(HasSubstr("\"fx\" is twice"), HasSubstr("line 3"))));
}

TEST(CheckJsonKeys, ObjectsHaveKeysOfTheirOwn) {
  EXPECT_THAT(CheckJsonKeys(R"({"a": {"a": 1}, "b": [{"a": 1}, {"a": 2}]})"), IsOk());
  EXPECT_THAT(CheckJsonKeys(R"([{"b": {"a": 1, "c": [{}], "a": 2}}])"),
              StatusIs(absl::StatusCode::kInvalidArgument));
}

TEST(CheckJsonKeys, TextsAreNoKeys) {
  EXPECT_THAT(CheckJsonKeys(R"({"a": "b", "b": "a", "c": ["a", "a"], "d": "a\": {"})"), IsOk());
  EXPECT_THAT(CheckJsonKeys(R"({"a": "x\"", "a": 1})"),
              StatusIs(absl::StatusCode::kInvalidArgument));
}

TEST(CheckJsonKeys, KeysOfOtherQuotesAreTheSame) {
  EXPECT_THAT(CheckJsonKeys(R"({a: 1, "a": 2})"), StatusIs(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(CheckJsonKeys(R"({'a': 1, "a": 2})"), StatusIs(absl::StatusCode::kInvalidArgument));
}

TEST(CheckJsonKeys, AnyBytesAreRead) {
  for (const char* text : {"", "{", "}", "{\"", "{\"a\\", "{\"a\":", "]]{a:1}", "{'", "\\"}) {
    CheckJsonKeys(text).IgnoreError();
  }
}

TEST(CheckJsonKeys, ErrorsCanBePrinted) {
  const std::string key = "\x1b[31m" + std::string(200, 'k');
  const absl::Status twice = CheckJsonKeys("{\"" + key + "\":1,\"" + key + "\":2}");
  EXPECT_THAT(std::string(twice.message()), HasSubstr("\\x1b[31mk"));
  EXPECT_LT(twice.message().size(), 200U);
}

}  // namespace
}  // namespace graspdb
