// Health, reflection, starting and draining.
#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include <thread>

#include "tests/server/raw_call.h"
#include "tests/server/server_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

// grpc.health.v1.HealthCheckResponse with status SERVING and NOT_SERVING.
constexpr char kServing[] = "\x08\x01";
constexpr char kNotServing[] = "\x08\x02";
constexpr char kWatch[] = "/grpc.health.v1.Health/Watch";

grpc::Status CallOverTheNetwork(const std::string& address, v1::CatalogStatus* status) {
  const auto stub =
      v1::CatalogService::NewStub(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()));
  grpc::ClientContext context;
  return stub->GetCatalogStatus(&context, v1::GetCatalogStatusRequest(), status);
}

class ServerLifeTest : public ServerTest {};

TEST_F(ServerLifeTest, HealthIsServing) {
  RawCall check(channel_, "/grpc.health.v1.Health/Check");
  ASSERT_TRUE(check.Write(""));
  EXPECT_THAT(check.Read(), Optional(std::string(kServing)));
}

TEST_F(ServerLifeTest, HealthWatchersAreNotifiedOfTheDrain) {
  std::thread drain;
  {
    RawCall watch(channel_, kWatch);
    ASSERT_TRUE(watch.Write(""));
    EXPECT_THAT(watch.Read(), Optional(std::string(kServing)));
    drain = std::thread([this] { server_->Drain(); });
    EXPECT_THAT(watch.Read(), Optional(std::string(kNotServing)));
  }
  drain.join();
}

TEST_F(ServerLifeTest, ReflectionListsTheServices) {
  RawCall reflection(channel_, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo");
  ASSERT_TRUE(reflection.Write("\x3a\x01*"));  // list_services: "*"
  const std::optional<std::string> answer = reflection.Read();
  ASSERT_TRUE(answer);
  for (const char* service :
       {"graspdb.v1.BackupService", "graspdb.v1.CatalogService", "graspdb.v1.CellService",
        "graspdb.v1.RecognitionService", "grpc.health.v1.Health"}) {
    EXPECT_THAT(*answer, HasSubstr(service));
  }
}

TEST_F(ServerLifeTest, ReflectionCanBeLeftOut) {
  options_.no_reflection = true;
  Restart();
  RawCall reflection(channel_, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo");
  reflection.Write("\x3a\x01*");
  EXPECT_EQ(reflection.Finish().error_code(), grpc::StatusCode::UNIMPLEMENTED);
  options_.no_reflection = false;
  Restart();
  RawCall again(channel_, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo");
  ASSERT_TRUE(again.Write("\x3a\x01*"));
  EXPECT_TRUE(again.Read());
}

TEST_F(ServerLifeTest, AddressHasTheSelectedPort) {
  EXPECT_THAT(server_->address(), ::testing::MatchesRegex("127\\.0\\.0\\.1:[1-9][0-9]*"));
  v1::CatalogStatus status;
  EXPECT_THAT(CallOverTheNetwork(server_->address(), &status), IsGrpcOk());
  EXPECT_EQ(status.descriptor_name(), "gsh288");
  EXPECT_NE(status.server_version(), "");
  EXPECT_GE(status.schema_version(), 1);
}

TEST_F(ServerLifeTest, DrainedServerRejectsCallsAndClosesItsDatabase) {
  ASSERT_THAT(CreateObject("mug"), IsGrpcOk());
  const std::string address = server_->address();
  v1::CatalogStatus status;
  ASSERT_THAT(CallOverTheNetwork(address, &status), IsGrpcOk());
  server_->Drain();
  server_->Drain();
  EXPECT_EQ(CallOverTheNetwork(address, &status).error_code(), grpc::StatusCode::UNAVAILABLE);
  const auto again = server::Server::Start(options_);
  EXPECT_THAT(again, IsOk());
}

// Over the network: gRPC's in-process channel is closed immediately.
TEST_F(ServerLifeTest, DrainWaitsForRunningCalls) {
  const auto stub = v1::RecognitionService::NewStub(
      grpc::CreateChannel(server_->address(), grpc::InsecureChannelCredentials()));
  grpc::ClientContext context;
  auto stream = stub->RecognizeStream(&context);
  v1::RecognizeStreamRequest frame;
  *frame.mutable_request() = RequestOf(PhotographEmptyTable());
  ASSERT_TRUE(stream->Write(frame));
  v1::RecognizeStreamResponse answer;
  ASSERT_TRUE(stream->Read(&answer));
  std::thread drain([this] { server_->Drain(); });
  EXPECT_TRUE(stream->Write(frame));
  EXPECT_TRUE(stream->Read(&answer));
  EXPECT_EQ(answer.response().status(), v1::NO_CLUSTER);
  stream->WritesDone();
  EXPECT_THAT(stream->Finish(), IsGrpcOk());
  drain.join();
}

TEST_F(ServerLifeTest, SecondServerOnTheDatabaseIsRejected) {
  EXPECT_THAT(server::Server::Start(options_),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("in use")));
  EXPECT_THAT(CreateObject("mug"), IsGrpcOk());
}

TEST_F(ServerLifeTest, SecondServerOnThePortIsRejected) {
  server::ServerOptions other = options_;
  other.database = (folder_.path() / "other").string();
  other.listen = server_->address();
  EXPECT_THAT(server::Server::Start(other),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("Choose another --listen")));
}

TEST_F(ServerLifeTest, RemoteAddressIsRejectedBeforeTheDatabaseIsCreated) {
  server::ServerOptions other = options_;
  other.database = (folder_.path() / "other").string();
  other.listen = "0.0.0.0:0";
  EXPECT_THAT(server::Server::Start(other), StatusIs(absl::StatusCode::kFailedPrecondition,
                                                     HasSubstr("--allow-remote-without-tls")));
  EXPECT_FALSE(std::filesystem::exists(other.database));
}

}  // namespace
}  // namespace graspdb::testing
