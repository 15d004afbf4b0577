// Clients that hang, stay silent or do not read, and the end of a server that has them.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <string_view>

#include "graspdb/v1/change_service.grpc.pb.h"
#include "graspdb/v1/recognition_service.grpc.pb.h"
#include "tests/faults/fault_fixture.h"

namespace graspdb::faults {
namespace {

using ::testing::HasSubstr;

constexpr int kManyClients = 200;
// The first half of HTTP/2's preface.
constexpr std::string_view kHalfPreface = "PRI * HTTP/2";

// A TCP connection that sends some bytes and nothing after them.
class SilentConnection {
 public:
  SilentConnection(const std::string& server, std::string_view bytes)
      : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port =
        htons(static_cast<std::uint16_t>(std::stoi(server.substr(server.rfind(':') + 1))));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_EQ(write(socket_, bytes.data(), bytes.size()), std::ssize(bytes));
  }
  ~SilentConnection() { close(socket_); }
  SilentConnection(const SilentConnection&) = delete;
  SilentConnection& operator=(const SilentConnection&) = delete;

 private:
  const int socket_;
};

class ConnectionsTest : public FaultTest {
 protected:
  std::shared_ptr<grpc::Channel> Channel() const {
    return grpc::CreateChannel(address_, grpc::InsecureChannelCredentials());
  }
  // The server's end after SIGTERM.
  void ExpectDrains() {
    server_->Signal(SIGTERM);
    const end_to_end::Finished ended = server_->Wait();
    EXPECT_EQ(ended.exit_status, 0);
    EXPECT_THAT(ended.err, HasSubstr("event=stop"));
  }
};

TEST_F(ConnectionsTest, IdleAndSilentClientsDoNotKeepOthersFromWorking) {
  StartServer("db", {"--drain", "0.5"});
  std::vector<client::Client> idle;
  idle.reserve(kManyClients);
  for (int i = 0; i < kManyClients; ++i) {
    idle.push_back(Connect());
    EXPECT_TRUE(idle.back().GetCatalogStatus().ok());
  }
  std::vector<std::unique_ptr<SilentConnection>> silent;
  silent.reserve(kManyClients);
  for (int i = 0; i < kManyClients; ++i) {
    silent.push_back(std::make_unique<SilentConnection>(
        address_, kHalfPreface.substr(0, static_cast<std::size_t>(i) % kHalfPreface.size())));
  }
  client::Client client = Connect();
  ASSERT_TRUE(samples_.Prepare(client).ok());
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(Teach(client, i).ok());
  for (client::Client& other : idle) EXPECT_EQ(other.GetCatalogStatus()->view_count(), 10);
  ExpectDrains();
}

TEST_F(ConnectionsTest, AWatcherThatDoesNotReadDelaysNobody) {
  StartServer("db", {"--drain", "0.5"});
  const auto stub = v1::ChangeService::NewStub(Channel());
  grpc::ClientContext context;
  v1::WatchCatalogRequest request;
  request.set_include_records(true);
  request.set_after_revision(0);
  const auto unread = stub->WatchCatalog(&context, request);
  client::Client client = Connect();
  ASSERT_TRUE(samples_.Prepare(client).ok());
  v1::UpdateObjectRequest update;
  update.mutable_object()->set_name("objects/ridge-0");
  update.mutable_update_mask()->add_paths("display_name");
  for (int i = 0; i < 500; ++i) {
    update.mutable_object()->set_display_name(std::to_string(i) + std::string(250, 'x'));
    ASSERT_TRUE(client.UpdateObject(update).ok());
  }
  ASSERT_TRUE(Teach(client, 0).ok());
  ExpectDrains();
}

TEST_F(ConnectionsTest, ACallThatHangsIsEndedAfterTheDrainTime) {
  StartServer("db", {"--drain", "0.5"});
  const auto stub = v1::RecognitionService::NewStub(Channel());
  grpc::ClientContext context;
  const auto hanging = stub->RecognizeStream(&context);
  v1::RecognizeStreamResponse answer;
  ASSERT_TRUE(hanging->Write(v1::RecognizeStreamRequest()));
  ASSERT_TRUE(hanging->Read(&answer));
  ExpectDrains();
  EXPECT_FALSE(hanging->Read(&answer));
  EXPECT_FALSE(hanging->Finish().ok());
}

}  // namespace
}  // namespace graspdb::faults
