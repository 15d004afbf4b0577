#include "console/connect_protocol.h"

#include <gmock/gmock.h>

#include "client/sdk/client.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::console {
namespace {

using graspdb::testing::StatusIs;
using ::testing::HasSubstr;

TEST(ConnectProtocol, KnowsTheContentTypesOfTheProtocol) {
  EXPECT_EQ(ParseContentType("application/json"), (BodyFormat{Encoding::kJson, false}));
  EXPECT_EQ(ParseContentType("Application/JSON; charset=utf-8"),
            (BodyFormat{Encoding::kJson, false}));
  EXPECT_EQ(ParseContentType("application/proto"), (BodyFormat{Encoding::kBinary, false}));
  EXPECT_EQ(ParseContentType("application/connect+json"), (BodyFormat{Encoding::kJson, true}));
  EXPECT_EQ(ParseContentType("application/connect+proto"), (BodyFormat{Encoding::kBinary, true}));
  for (const char* other : {"", ";", "text/plain", "application/jsonx", "application/grpc",
                            "application/x-www-form-urlencoded", "multipart/form-data"}) {
    EXPECT_EQ(ParseContentType(other), std::nullopt) << other;
  }
}

TEST(ConnectProtocol, GivesEachCodeItsNameAndStatusOfHttp) {
  EXPECT_EQ(CodeName(absl::StatusCode::kCancelled), "canceled");
  EXPECT_EQ(HttpStatus(absl::StatusCode::kCancelled), 499);
  EXPECT_EQ(CodeName(absl::StatusCode::kUnauthenticated), "unauthenticated");
  EXPECT_EQ(HttpStatus(absl::StatusCode::kUnauthenticated), 401);
  EXPECT_EQ(HttpStatus(absl::StatusCode::kFailedPrecondition), 400);
  EXPECT_EQ(HttpStatus(absl::StatusCode::kUnimplemented), 501);
  EXPECT_EQ(CodeName(static_cast<absl::StatusCode>(99)), "unknown");
}

TEST(ConnectProtocol, AnErrorHasItsDetails) {
  google::rpc::ErrorInfo info;
  info.set_reason("QUEUE_FULL");
  google::rpc::Status status;
  status.add_details()->PackFrom(info);
  absl::Status error = absl::ResourceExhaustedError("line 1\nline \"2\"\x1b \xff");
  error.SetPayload(client::kErrorDetails, absl::Cord(status.SerializeAsString()));
  // The bytes of the detail end with "=" in Base64, which the protocol leaves out.
  EXPECT_EQ(ErrorJson(error),
            R"({"code":"resource_exhausted","details":[{"debug":{"reason":"QUEUE_FULL"},)"
            R"("type":"google.rpc.ErrorInfo","value":"CgpRVUVVRV9GVUxM"}],)"
            R"("message":"line 1\nline \"2\"? ?"})");
}

TEST(ConnectProtocol, ADetailOfAnotherTypeHasItsBytesOnly) {
  google::rpc::Status status;
  google::protobuf::Any* detail = status.add_details();
  detail->set_type_url("type.googleapis.com/not.Known");
  detail->set_value("a");
  absl::Status error = absl::InternalError("x");
  error.SetPayload(client::kErrorDetails, absl::Cord(status.SerializeAsString()));
  EXPECT_THAT(ErrorJson(error), HasSubstr(R"([{"type":"not.Known","value":"YQ"}])"));
}

TEST(ConnectProtocol, MessagesOfStreamsAreInEnvelopes) {
  const std::string text(300, 'x');
  const std::string enclosed = Envelope(text);
  EXPECT_EQ(enclosed.substr(0, 5), std::string("\0\0\0\x01\x2c", 5));
  EXPECT_EQ(OnlyMessage(enclosed).value(), text);
  EXPECT_EQ(OnlyMessage(Envelope("")).value(), "");
  EXPECT_EQ(EndOfStream(absl::OkStatus()), std::string("\x02\0\0\0\x02{}", 7));
  EXPECT_THAT(EndOfStream(absl::NotFoundError("none")),
              HasSubstr(R"({"error":{"code":"not_found","message":"none"}})"));
}

TEST(ConnectProtocol, ABodyOfAStreamHasOneMessage) {
  const auto wrong = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT(OnlyMessage(""), StatusIs(wrong, HasSubstr("envelope")));
  EXPECT_THAT(OnlyMessage(std::string(4, '\0')), StatusIs(wrong, HasSubstr("envelope")));
  EXPECT_THAT(OnlyMessage(Envelope("abc").substr(0, 7)), StatusIs(wrong, HasSubstr("one message")));
  EXPECT_THAT(OnlyMessage(Envelope("a") + Envelope("b")),
              StatusIs(wrong, HasSubstr("one message")));
  EXPECT_THAT(OnlyMessage(std::string("\xff\0\0\0\0", 5)),
              StatusIs(wrong, HasSubstr("one message")));
  EXPECT_THAT(OnlyMessage(std::string("\x01\0\0\0\0", 5)),
              StatusIs(absl::StatusCode::kUnimplemented, HasSubstr("compressed")));
}

TEST(ConnectProtocol, ATimeoutHasUpToTenDigits) {
  EXPECT_EQ(ParseTimeout("1500").value(), absl::Milliseconds(1500));
  EXPECT_EQ(ParseTimeout("9999999999").value(), absl::Milliseconds(9'999'999'999));
  for (const char* other : {"", "-1", "+1", " 1", "1.5", "1e3", "12345678901", "x"}) {
    EXPECT_THAT(ParseTimeout(other),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("digits")))
        << other;
  }
}

}  // namespace
}  // namespace graspdb::console
