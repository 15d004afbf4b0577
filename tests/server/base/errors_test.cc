#include "server/base/errors.h"

#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/server_builder.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "absl/strings/cord.h"
#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "server/calls/call_guard.h"
#include "server/calls/handle.h"
#include "tests/server/error_details.h"

namespace graspdb::server {
namespace {

using testing::ExpectBadField;
using testing::IsGrpcOk;
using testing::ReasonOf;

TEST(Errors, CodesAreUnchanged) {
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

TEST(Errors, ReasonKeepsOtherDetails) {
  const absl::Status status = WithReason(InvalidField("a.b", "is wrong in every way"), "SO_WRONG");
  const grpc::Status mapped = ToGrpcStatus(status);
  EXPECT_EQ(ReasonOf(mapped), "SO_WRONG");
  ExpectBadField(mapped, "a.b", "is wrong in every way");
}

class LongErrorsTest : public ::testing::Test {
 protected:
  // Returns only `status`, over TCP, whose headers are limited, unlike those within a process.
  grpc::Status Answered(const absl::Status& status) {
    class Service final : public v1::CatalogService::Service {
     public:
      explicit Service(absl::Status status) : status_(std::move(status)) {}
      grpc::Status GetObject(grpc::ServerContext* context, const v1::GetObjectRequest* /*request*/,
                             v1::Object* /*response*/) override {
        return Handle(*context, "GetObject", [&] { return status_; });
      }

     private:
      const absl::Status status_;
    } service(status);
    spdlog::set_level(spdlog::level::off);
    int port = 0;
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&service);
    const AccessRules access;
    GuardCalls(access, builder);
    const auto server = builder.BuildAndStart();
    const auto stub = v1::CatalogService::NewStub(grpc::CreateChannel(
        "127.0.0.1:" + std::to_string(port), grpc::InsecureChannelCredentials()));
    grpc::ClientContext context;
    v1::Object ignored;
    return stub->GetObject(&context, {}, &ignored);
  }
};

TEST_F(LongErrorsTest, LongTextKeepsCodeAndDetails) {
  // Each of its bytes takes three on the wire.
  std::string text;
  while (text.size() < 100'000) text += "\u20ac";
  const grpc::Status field = Answered(InvalidField("a[0]." + text, text));
  EXPECT_EQ(field.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << field.error_message();
  EXPECT_THAT(field.error_message(), ::testing::StartsWith("a[0].\u20ac"));
  EXPECT_THAT(testing::FieldsOf(field), ::testing::ElementsAre(::testing::StartsWith("a[0].")));
  const grpc::Status named = Answered(WithReason(absl::AbortedError(text), "SO_LONG"));
  EXPECT_EQ(named.error_code(), grpc::StatusCode::ABORTED) << named.error_message();
  EXPECT_EQ(testing::ReasonOf(named), "SO_LONG");
}

TEST_F(LongErrorsTest, OversizedDetailsAreLeftOutExceptTheReason) {
  absl::Status status = WithReason(absl::AbortedError("it was changed; read it again"), "CHANGED");
  status.SetPayload("type.googleapis.com/a.Long", absl::Cord(std::string(100'000, 'x')));
  const grpc::Status answer = Answered(status);
  EXPECT_EQ(answer.error_code(), grpc::StatusCode::ABORTED);
  EXPECT_EQ(testing::ReasonOf(answer), "CHANGED");
}

TEST_F(LongErrorsTest, InvalidUtf8ReachesTheCaller) {
  const grpc::Status answer = Answered(absl::InternalError("a library failed: \xff\xfe; restart"));
  EXPECT_EQ(answer.error_message(), "a library failed: ??; restart");
  EXPECT_EQ(testing::ReasonOf(answer), "INTERNAL");
}

}  // namespace
}  // namespace graspdb::server
