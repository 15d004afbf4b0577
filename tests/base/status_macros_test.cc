#include "base/status_macros.h"

#include <gmock/gmock.h>

#include <memory>
#include <string>
#include <utility>

namespace graspdb {
namespace {

// Returns the status and counts the calls.
absl::Status Counted(const absl::Status& status, int& calls) {
  ++calls;
  return status;
}

TEST(ReturnIfError, GoesOnAfterSuccessAndEvaluatesOnce) {
  int calls = 0;
  const auto run = [&]() -> absl::Status {
    RETURN_IF_ERROR(Counted(absl::OkStatus(), calls));
    return absl::AbortedError("went on");
  };
  EXPECT_EQ(run(), absl::AbortedError("went on"));
  EXPECT_EQ(calls, 1);
}

TEST(ReturnIfError, ReturnsTheErrorFromFunctionsOfStatusAndOfStatusOr) {
  int calls = 0;
  const absl::Status error = absl::NotFoundError("no view");
  const auto status = [&]() -> absl::Status {
    RETURN_IF_ERROR(Counted(error, calls));
    return absl::OkStatus();
  };
  const auto status_or = [&]() -> absl::StatusOr<int> {
    RETURN_IF_ERROR(Counted(error, calls));
    return 1;
  };
  EXPECT_EQ(status(), error);
  EXPECT_EQ(status_or().status(), error);
  EXPECT_EQ(calls, 2);
}

TEST(ReturnIfError, IsOneStatementOfAnIfWithElse) {
  const auto run = [](bool check) -> absl::StatusOr<std::string> {
    if (check)
      RETURN_IF_ERROR(absl::OkStatus());
    else
      return std::string("not checked");
    return std::string("checked");
  };
  EXPECT_EQ(*run(true), "checked");
  EXPECT_EQ(*run(false), "not checked");
}

TEST(ReturnIfError, TakesAVariableNamedStatus) {
  const auto run = [](const absl::Status& status) -> absl::Status {
    RETURN_IF_ERROR(status);
    return absl::AbortedError("went on");
  };
  EXPECT_EQ(run(absl::CancelledError("stopped")), absl::CancelledError("stopped"));
  EXPECT_EQ(run(absl::OkStatus()), absl::AbortedError("went on"));
}

TEST(AssignOrReturn, MovesTheValue) {
  const auto run = []() -> absl::StatusOr<int> {
    ASSIGN_OR_RETURN(const auto value, absl::StatusOr<std::unique_ptr<int>>(new int(7)));
    return *value;
  };
  ASSERT_TRUE(run().ok());
  EXPECT_EQ(*run(), 7);
}

TEST(AssignOrReturn, AssignsToAVariableThatExists) {
  std::string value = "before";
  const auto run = [&](const absl::StatusOr<std::string>& given) -> absl::Status {
    ASSIGN_OR_RETURN(value, given);
    return absl::OkStatus();
  };
  EXPECT_EQ(run(absl::NotFoundError("none")), absl::NotFoundError("none"));
  EXPECT_EQ(value, "before");
  EXPECT_TRUE(run("after").ok());
  EXPECT_EQ(value, "after");
}

TEST(AssignOrReturn, TakesCommasOfTemplatesAndTwiceInALine) {
  const auto run = []() -> absl::StatusOr<int> {
    // clang-format off
    ASSIGN_OR_RETURN(auto pair, absl::StatusOr<std::pair<int, int>>({2, 3})); ASSIGN_OR_RETURN(auto one, absl::StatusOr<int>(1));
    // clang-format on
    return pair.first + pair.second + one;
  };
  EXPECT_EQ(*run(), 6);
}

}  // namespace
}  // namespace graspdb
