#include "server/calls/call_places.h"

#include <gmock/gmock.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "graspdb/v1/change_service.pb.h"
#include "tests/server/access_fixture.h"
#include "tests/server/raw_call.h"
#include "tests/server/service_rig.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

using ::testing::HasSubstr;
using Kind = server::CallPlaces::Kind;

constexpr char kRetryInfo[] = "type.googleapis.com/google.rpc.RetryInfo";
constexpr char kReflectionMethod[] =
    "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo";

// More than the server has places for, and the threads of any earlier server.
constexpr int kManyStreams = 500;

class CallPlacesTest : public ::testing::Test {
 protected:
  absl::Status Take(const std::string& caller, bool is_identified = false,
                    Kind kind = Kind::kStream) {
    auto place = places_.Take(kind, {caller, is_identified}, nullptr);
    if (!place.ok()) return place.status();
    taken_.push_back(*std::move(place));
    return absl::OkStatus();
  }
  int CountPlaces(const std::string& caller, bool is_identified = false) {
    int count = 0;
    while (Take(caller, is_identified).ok()) ++count;
    return count;
  }

  server::CallPlaces places_{{.streams = 16, .unary = 4}};
  std::vector<server::CallPlaces::Place> taken_;
};

TEST_F(CallPlacesTest, ACallerGetsHalfOfThem) {
  EXPECT_EQ(CountPlaces("ipv4:10.0.0.1"), 8);
  EXPECT_THAT(Take("ipv4:10.0.0.2"), IsOk());
  EXPECT_EQ(places_.used(Kind::kStream), 9);
  taken_.clear();
  EXPECT_EQ(places_.used(Kind::kStream), 0);
  EXPECT_EQ(CountPlaces("ipv4:10.0.0.1"), 8);
}

TEST_F(CallPlacesTest, AQuarterIsLeftToCallersWithIdentity) {
  EXPECT_EQ(CountPlaces("ipv4:10.0.0.1") + CountPlaces("ipv4:10.0.0.2"), 12);
  EXPECT_EQ(CountPlaces("press-3", /*is_identified=*/true), 4);
}

TEST_F(CallPlacesTest, TheRestIsRefusedWithRetryInfoAndItsReason) {
  CountPlaces("ipv4:10.0.0.1");
  const absl::Status full = Take("ipv4:10.0.0.1");
  EXPECT_THAT(full, StatusIs(absl::StatusCode::kResourceExhausted, HasSubstr("of ipv4:10.0.0.1")));
  EXPECT_TRUE(full.GetPayload(kRetryInfo));
  while (Take("ipv4:10.0.0.1", false, Kind::kUnary).ok()) continue;
  EXPECT_EQ(places_.used(Kind::kUnary), 2) << "unary calls have their own places";
}

// Streams of one method that a client leaves open.
class IdleStreamsTest : public ServerTest {
 protected:
  using Streams = std::vector<std::unique_ptr<RawCall>>;

  Streams Open(const std::string& method, const std::string& message = "") {
    Streams out;
    out.reserve(kManyStreams);
    for (int i = 0; i < kManyStreams; ++i) {
      out.push_back(std::make_unique<RawCall>(channel_, method));
      if (!message.empty()) out.back()->Write(message);
    }
    return out;
  }
  void ExpectServed() {
    v1::CatalogStatus status;
    for (int i = 0; i < 50; ++i) {
      ASSERT_THAT(Call(&Catalog::GetCatalogStatus, v1::GetCatalogStatusRequest(), &status),
                  IsGrpcOk());
    }
    EXPECT_EQ(Answer(RequestOf(PhotographEmptyTable())).status(), v1::NO_CLUSTER);
  }
};

TEST_F(IdleStreamsTest, OthersAreServedBesideEachKindOfThem) {
  for (const char* method :
       {"/graspdb.v1.RecognitionService/RecognizeStream", "/graspdb.v1.CatalogService/UploadViews",
        "/graspdb.v1.UploadService/WriteUploadViews"}) {
    SCOPED_TRACE(method);
    const Streams streams = Open(method);
    ExpectServed();
    const grpc::Status refused = streams.back()->Finish();
    ExpectError(refused, grpc::StatusCode::RESOURCE_EXHAUSTED, "no place for another stream");
    EXPECT_EQ(ReasonOf(refused), "STREAMS_FULL");
    EXPECT_TRUE(HasRetryInfo(refused));
  }
}

TEST_F(IdleStreamsTest, OthersAreServedBesideWatchers) {
  v1::WatchCatalogRequest request;
  request.set_heartbeat_s(3600);
  const Streams streams =
      Open("/graspdb.v1.ChangeService/WatchCatalog", request.SerializeAsString());
  ExpectServed();
}

TEST_F(IdleStreamsTest, OthersAreServedBesideReflectionWhichAnswersTheNextOne) {
  const Streams streams = Open(kReflectionMethod);
  ExpectServed();
  RawCall reflection(channel_, kReflectionMethod);
  ASSERT_TRUE(reflection.Write("\x3a\x01*"));  // list_services: "*"
  EXPECT_THAT(reflection.Read().value_or(""), HasSubstr("graspdb.v1.CatalogService"));
}

TEST_F(IdleStreamsTest, ManyCallsAtOnceAreAnsweredOrMayBeRepeated) {
  options_.workers = 1;
  options_.queue = 1;
  Restart();
  const v1::RecognizeRequest frame = RequestOf(PhotographEmptyTable());
  constexpr int kCallers = 100;
  std::vector<std::thread> callers;
  callers.reserve(kCallers);
  for (int i = 0; i < kCallers; ++i) {
    callers.emplace_back([&] {
      const grpc::Status status = Call(&Recognition::Recognize, frame);
      EXPECT_TRUE(status.ok() || HasRetryInfo(status)) << status.error_message();
    });
  }
  for (std::thread& caller : callers) caller.join();
}

// With identities.
class IdleStreamsOfCallersTest : public AccessTest {};

TEST_F(IdleStreamsOfCallersTest, AnotherIdentityHasItsStream) {
  const std::string greedy = Add("greedy", {v1::ROLE_RECOGNISE});
  std::vector<std::unique_ptr<RawCall>> streams;
  streams.reserve(kManyStreams);
  for (int i = 0; i < kManyStreams; ++i) {
    streams.push_back(std::make_unique<RawCall>(
        channel_, "/graspdb.v1.RecognitionService/RecognizeStream", std::vector{greedy}));
  }
  grpc::ClientContext context;
  context.AddMetadata("authorization",
                      "Bearer " + Add("press-3", {v1::ROLE_READ, v1::ROLE_RECOGNISE}));
  const auto stream = v1::RecognitionService::NewStub(channel_)->RecognizeStream(&context);
  v1::RecognizeStreamResponse answer;
  EXPECT_TRUE(stream->Write({}) && stream->Read(&answer));
  stream->WritesDone();
  EXPECT_THAT(stream->Finish(), IsGrpcOk());
  // Audited, but not each of the hundreds.
  const auto audited = Audited();
  const auto refused = std::ranges::count_if(audited, [](const v1::AuditRecord& record) {
    return record.code() == "RESOURCE_EXHAUSTED" && record.identity() == "greedy";
  });
  EXPECT_GE(refused, 1);
  EXPECT_LT(refused, kManyStreams / 4);
}

// Whether the stream's next frame gets an answer.
bool IsAnswered(v1::RecognitionService::Stub& stub, grpc::ClientContext& context) {
  const auto stream = stub.RecognizeStream(&context);
  v1::RecognizeStreamResponse answer;
  const bool is_answered = stream->Write({}) && stream->Read(&answer);
  stream->WritesDone();
  (void)stream->Finish();
  return is_answered;
}

TEST_F(IdleStreamsTest, TheLongestIdleOneLeavesItsPlaceToTheNextOne) {
  ServiceRig rig((folder_.path() / "rig").string(), /*slots=*/1, /*waiting=*/1);
  rig.LimitCalls({.streams = 2, .unary = 2, .idle = std::chrono::milliseconds(0)});
  grpc::ClientContext idle_context;
  const auto idle = rig.stub().RecognizeStream(&idle_context);
  v1::RecognizeStreamResponse answer;
  ASSERT_TRUE(idle->Write({}) && idle->Read(&answer));
  std::ostringstream log;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(
      "test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log)));
  spdlog::set_level(spdlog::level::warn);
  for (bool is_answered = false; !is_answered;) {
    grpc::ClientContext next;
    is_answered = IsAnswered(rig.stub(), next);
  }
  EXPECT_FALSE(idle->Read(&answer));
  EXPECT_EQ(idle->Finish().error_code(), grpc::StatusCode::CANCELLED);
  spdlog::set_default_logger(before);
  spdlog::set_level(spdlog::level::off);
  EXPECT_THAT(log.str(), ::testing::ContainsRegex("method=RecognizeStream .*code=CANCELLED .*"
                                                  "another stream needed the place"));
}

}  // namespace
}  // namespace graspdb::testing
