#include "client/cli/base/command.h"

#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>

#include "absl/strings/str_cat.h"
#include "client/cli/base/command_line.h"
#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "tests/testing/busy_status.h"

namespace graspdb::client {
namespace {

// Never has room for a call.
class FullServer : public v1::CatalogService::Service {
 public:
  FullServer() {
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  grpc::Status GetCatalogStatus(grpc::ServerContext*, const v1::GetCatalogStatusRequest*,
                                v1::CatalogStatus*) override {
    ++calls_;
    return graspdb::testing::BusyFor(absl::Milliseconds(1));
  }
  std::string address() const { return absl::StrCat("127.0.0.1:", port_); }
  int calls() const { return calls_; }

 private:
  int port_ = 0;
  std::atomic<int> calls_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

TEST(Command, AnIdOrAWholeNameMayBeGiven) {
  EXPECT_EQ(ResourceName("objects", "mug"), "objects/mug");
  EXPECT_EQ(ResourceName("objects", "objects/mug"), "objects/mug");
  EXPECT_EQ(ResourceName("cells", "objects/mug"), "cells/objects/mug");
}

TEST(Command, JsonIsCanonicalAndOneLine) {
  v1::RecognizeResponse response;
  response.set_status(v1::NO_CLUSTER);
  response.set_catalog_revision(7);
  response.add_detections()->set_stable_pose("a\nb");
  EXPECT_EQ(
      ToJson(response).value(),
      R"({"status":"NO_CLUSTER","catalogRevision":"7","detections":[{"stablePose":"a\nb"}]})");
}

TEST(Command, GlobalFlagsMayFollowTheCommand) {
  CLI::App app;
  bool json = false;
  app.add_flag("--json", json);
  AddCommand(app, "status", "Print the status");
  app.parse("status --json");
  EXPECT_TRUE(json);
}

TEST(Command, CallsAreSentAgainToABusyServerAsOftenAsTheFlagSays) {
  const FullServer server;
  CLI::App app;
  GlobalOptions global;
  AddGlobalFlags(app, &global);
  app.parse("--busy-retries 2 --timeout 3600 --server " + server.address());
  const auto status = Connect(global).GetCatalogStatus();
  EXPECT_TRUE(absl::IsResourceExhausted(status.status())) << status.status();
  EXPECT_EQ(server.calls(), 3);
}

}  // namespace
}  // namespace graspdb::client
