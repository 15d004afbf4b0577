// Clients that hang, stay silent, do not read, or are many, and the end of a server that has them.
#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/support/channel_arguments.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "graspdb/v1/cell_service.grpc.pb.h"
#include "graspdb/v1/change_service.grpc.pb.h"
#include "graspdb/v1/recognition_service.grpc.pb.h"
#include "tests/faults/fault_fixture.h"
#include "tests/faults/silent_connection.h"

namespace graspdb::faults {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kManyClients = 200;
// Of the streams of a server one caller may have half.
constexpr std::size_t kStreamsOfCaller = 128;
// The first half of HTTP/2's preface.
constexpr std::string_view kHalfPreface = "PRI * HTTP/2";

// A cell with a connection of its own, on which it watches the catalogue.
class WatchingCell {
 public:
  WatchingCell(const std::string& server, std::string name)
      : name_(std::move(name)),
        channel_(OwnConnection(server)),
        cells_(v1::CellService::NewStub(channel_)),
        changes_(v1::ChangeService::NewStub(channel_)),
        stream_(changes_->WatchCatalog(&context_, v1::WatchCatalogRequest())) {}
  ~WatchingCell() {
    context_.TryCancel();
    if (!ended_) Finish();
  }
  WatchingCell(const WatchingCell&) = delete;
  WatchingCell& operator=(const WatchingCell&) = delete;

  // Waits for the first heartbeat; false if the server refused it.
  bool Watches() { return stream_->Read(&response_); }
  // Waits for the change of a resource.
  bool SeesChangeOf(const std::string& resource) {
    while (stream_->Read(&response_)) {
      for (const v1::ResourceChange& change : response_.changes()) {
        if (change.name() == resource) return true;
      }
    }
    return false;
  }
  grpc::Status Finish() {
    ended_ = true;
    return stream_->Finish();
  }
  // What an agent does every few seconds.
  grpc::Status ReadCell() {
    grpc::ClientContext context;
    v1::GetCellRequest request;
    request.set_name(name_);
    v1::Cell cell;
    return cells_->GetCell(&context, request, &cell);
  }

 private:
  static std::shared_ptr<grpc::Channel> OwnConnection(const std::string& server) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return grpc::CreateCustomChannel(server, grpc::InsecureChannelCredentials(), arguments);
  }

  const std::string name_;
  const std::shared_ptr<grpc::Channel> channel_;
  const std::unique_ptr<v1::CellService::Stub> cells_;
  const std::unique_ptr<v1::ChangeService::Stub> changes_;
  grpc::ClientContext context_;
  v1::WatchCatalogResponse response_;
  const std::unique_ptr<grpc::ClientReader<v1::WatchCatalogResponse>> stream_;
  bool ended_ = false;
};

// Sends frames one after the other on a thread, which must be recognised as that view.
class FrameSender {
 public:
  FrameSender(client::Client client, const v1::RecognizeRequest& frame, const std::string& view)
      : client_(std::move(client)), thread_([this, &frame, view] {
          while (!stopping_) {
            const auto answer = client_.Recognize(frame);
            ASSERT_TRUE(answer.ok()) << answer.status();
            ASSERT_EQ(answer->detections(0).candidates(0).view(), view);
          }
        }) {}
  ~FrameSender() {
    stopping_ = true;
    thread_.join();
  }
  FrameSender(const FrameSender&) = delete;
  FrameSender& operator=(const FrameSender&) = delete;

 private:
  client::Client client_;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;  // the last member: it uses the others
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
  ASSERT_EQ(samples_.Prepare(client), absl::OkStatus());
  for (int i = 0; i < 10; ++i) ASSERT_EQ(Teach(client, i), absl::OkStatus());
  for (client::Client& other : idle) EXPECT_EQ(other.GetCatalogStatus()->view_count(), 10);
  ExpectDrains();
}

class ManyCellsTest : public ConnectionsTest {
 protected:
  using Cells = std::vector<std::unique_ptr<WatchingCell>>;

  // Files that the database may open meanwhile.
  static constexpr std::ptrdiff_t kOtherFiles = 8;

  // A server with a view and kManyClients cells.
  void StartPlant(std::vector<std::string> flags) {
    Prepare();
    flags.emplace_back("--drain");
    flags.emplace_back("0.5");
    StartServer("db", flags);
    client::Client client = Connect();
    ASSERT_EQ(samples_.Prepare(client), absl::OkStatus());
    ASSERT_EQ(Teach(client, 0), absl::OkStatus());
    for (int i = 0; i < kManyClients; ++i) {
      v1::CreateCellRequest request;
      request.set_cell_id(absl::StrCat("press-", i));
      ASSERT_TRUE(client.CreateCell(request).ok());
    }
  }
  // Connects all cells: to `watching` those that the server allows to watch, to `refused` the
  // others.
  void ConnectCells(Cells& watching, Cells& refused) const {
    for (int i = 0; i < kManyClients; ++i) {
      auto cell = std::make_unique<WatchingCell>(address_, absl::StrCat("cells/press-", i));
      if (cell->Watches()) {
        watching.push_back(std::move(cell));
        continue;
      }
      const grpc::Status status = cell->Finish();
      EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
      EXPECT_THAT(status.error_message(), HasSubstr("watchers are connected already"));
      refused.push_back(std::move(cell));
    }
  }
  // All cells are connected while frames are sent and views are taught, and leave. Expects that
  // `watchers` of them may watch.
  void ExpectServesCells(std::size_t watchers) {
    client::Client teacher = Connect();
    ASSERT_TRUE(teacher.Recognize(samples_.Scan(0)).ok());
    const std::ptrdiff_t before = Descriptors();
    {
      FrameSender robot(Connect(), samples_.Scan(0), NameOf(0));
      Cells watching;
      Cells refused;
      ConnectCells(watching, refused);
      EXPECT_EQ(watching.size(), watchers);
      EXPECT_GE(Descriptors(), before + kManyClients - kOtherFiles);
      constexpr int kTaught = 5;
      for (int i = 1; i <= kTaught; ++i) ASSERT_EQ(Teach(teacher, i), absl::OkStatus());
      for (const auto& cell : watching) EXPECT_TRUE(cell->SeesChangeOf(NameOf(kTaught)));
      for (const Cells* cells : {&watching, &refused}) {
        for (const auto& cell : *cells) EXPECT_TRUE(cell->ReadCell().ok());
      }
    }
    AwaitDescriptors(before + kOtherFiles);
  }
  // Of the server.
  std::ptrdiff_t Descriptors() const {
    const auto folder = std::filesystem::path("/proc") / std::to_string(server_->id()) / "fd";
    return std::distance(std::filesystem::directory_iterator(folder),
                         std::filesystem::directory_iterator());
  }
  void AwaitDescriptors(std::ptrdiff_t most) const {
    const auto limit = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    while (Descriptors() > most && std::chrono::steady_clock::now() < limit) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    EXPECT_LE(Descriptors(), most);
  }
};

TEST_F(ManyCellsTest, AQuarterOfTheThreadsMayWatchAndTheOtherCellsAreServedAsWell) {
  // Room for 256 messages, each with its thread.
  StartPlant({"--workers", "2", "--memory-mib", "4096", "--max-message-mib", "4"});
  ExpectServesCells(64);
  // The places are free again.
  while (!WatchingCell(address_, "cells/press-0").Watches()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ExpectDrains();
}

TEST_F(ManyCellsTest, AllCellsWatchWhereThereAreEnoughThreads) {
  StartPlant({"--workers", "400"});  // of 816 threads, 204 may watch
  ExpectServesCells(kManyClients);
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
  ASSERT_EQ(samples_.Prepare(client), absl::OkStatus());
  v1::UpdateObjectRequest update;
  update.mutable_object()->set_name("objects/ridge-0");
  update.mutable_update_mask()->add_paths("display_name");
  for (int i = 0; i < 500; ++i) {
    update.mutable_object()->set_display_name(std::to_string(i) + std::string(250, 'x'));
    ASSERT_TRUE(client.UpdateObject(update).ok());
  }
  ASSERT_EQ(Teach(client, 0), absl::OkStatus());
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

TEST_F(ConnectionsTest, DoctorReportsNoStreamsWhereThereArePlaces) {
  StartServer("db");
  EXPECT_THAT(Graspdb({"doctor"}).out, Not(HasSubstr("refuses streams")));
}

TEST_F(ConnectionsTest, DoctorReportsThatStreamsHaveNoPlaceLeft) {
  StartServer("db");
  const auto stub = v1::RecognitionService::NewStub(Channel());
  std::vector<grpc::ClientContext> contexts(kStreamsOfCaller);
  std::vector<decltype(stub->RecognizeStream(nullptr))> idle;
  v1::RecognizeStreamResponse answer;
  for (grpc::ClientContext& context : contexts) {
    idle.push_back(stub->RecognizeStream(&context));
    ASSERT_TRUE(idle.back()->Write(v1::RecognizeStreamRequest()) && idle.back()->Read(&answer))
        << idle.size();
  }
  const end_to_end::Finished doctor = Graspdb({"doctor"});
  EXPECT_EQ(doctor.exit_status, 1);
  EXPECT_THAT(doctor.out, HasSubstr("error    server: refuses streams: "));
  for (const auto& stream : idle) {
    stream->WritesDone();
    EXPECT_TRUE(stream->Finish().ok());
  }
}

}  // namespace
}  // namespace graspdb::faults
