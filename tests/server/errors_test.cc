#include "server/errors.h"

#include <gmock/gmock.h>

#include <tuple>

#include "tests/server/error_details.h"

namespace graspdb::server {
namespace {

using testing::ExpectBadField;
using testing::IsGrpcOk;
using testing::ReasonOf;

TEST(Errors, EveryCodeStaysWhatItIs) {
  for (int code = 1; code <= 16; ++code) {
    const absl::Status status(static_cast<absl::StatusCode>(code), "what is wrong; what to do");
    const grpc::Status mapped = ToGrpcStatus(status);
    EXPECT_EQ(static_cast<int>(mapped.error_code()), code);
    EXPECT_EQ(mapped.error_message(), "what is wrong; what to do");
    EXPECT_EQ(ReasonOf(mapped), absl::StatusCodeToString(status.code()));
  }
  EXPECT_THAT(ToGrpcStatus(absl::OkStatus()), IsGrpcOk());
}

TEST(Errors, AWrongFieldIsNamedInTextAndDetails) {
  ExpectBadField(ToGrpcStatus(InvalidField("view.cloud", "has no measurement at all")),
                 "view.cloud", "view.cloud: has no measurement at all");
}

TEST(Errors, AReasonStaysAndKeepsOtherDetails) {
  const absl::Status status = WithReason(InvalidField("a.b", "is wrong in every way"), "SO_WRONG");
  const grpc::Status mapped = ToGrpcStatus(status);
  EXPECT_EQ(ReasonOf(mapped), "SO_WRONG");
  ExpectBadField(mapped, "a.b", "is wrong in every way");
}

}  // namespace
}  // namespace graspdb::server
