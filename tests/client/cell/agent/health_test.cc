#include "client/cell/agent/health.h"

#include <gmock/gmock.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>

#include <atomic>
#include <thread>

#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::StartsWith;

// grpc.health.v1.HealthCheckResponse by hand: field 1, a varint; absent where it is zero.
constexpr char kServing = 1;
constexpr char kNotServing = 2;

grpc::ByteBuffer CheckRequest() {
  grpc::Slice slice("\x0a\x0cgraspdb.cell");  // field 1, a string of twelve characters
  return {&slice, 1};
}

char StateOf(const std::string& address) {
  grpc::GenericStub stub(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()));
  grpc::ClientContext context;
  grpc::CompletionQueue queue;
  grpc::ByteBuffer response;
  grpc::Status status;
  const auto call =
      stub.PrepareUnaryCall(&context, "/grpc.health.v1.Health/Check", CheckRequest(), &queue);
  call->StartCall();
  call->Finish(&response, &status, nullptr);
  void* tag = nullptr;
  bool done = false;
  EXPECT_TRUE(queue.Next(&tag, &done));
  if (!status.ok()) return -1;
  grpc::Slice slice;
  EXPECT_TRUE(response.DumpToSingleSlice(&slice).ok());
  return slice.size() < 2 ? '\0' : static_cast<char>(slice.begin()[1]);
}

TEST(Health, ReportsWhetherTheCellIsReady) {
  std::atomic<bool> ready = false;
  const auto health = Health::Start(
      "127.0.0.1:0", [&] { return ready.load(); }, absl::Milliseconds(1));
  ASSERT_THAT(health, IsOk());
  EXPECT_THAT((*health)->address(), StartsWith("127.0.0.1:"));
  while (StateOf((*health)->address()) != kNotServing) std::this_thread::yield();
  ready = true;
  while (StateOf((*health)->address()) != kServing) std::this_thread::yield();
}

TEST(Health, APortInUseIsAnError) {
  const auto first = Health::Start(
      "127.0.0.1:0", [] { return true; }, absl::Seconds(1));
  ASSERT_THAT(first, IsOk());
  EXPECT_THAT(Health::Start((*first)->address(), [] { return true; }, absl::Seconds(1)),
              StatusIs(absl::StatusCode::kUnavailable));
}

}  // namespace
}  // namespace graspdb::client
