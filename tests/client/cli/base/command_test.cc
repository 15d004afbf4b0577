#include "client/cli/base/command.h"

#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <string>
#include <utility>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "server/base/errors.h"
#include "tests/testing/busy_status.h"

namespace graspdb::client {
namespace {

// Refuses all calls.
class RefusingServer : public v1::CatalogService::Service {
 public:
  explicit RefusingServer(grpc::Status refusal) : refusal_(std::move(refusal)) {
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }
  grpc::Status GetCatalogStatus(grpc::ServerContext*, const v1::GetCatalogStatusRequest*,
                                v1::CatalogStatus*) override {
    ++calls_;
    return refusal_;
  }
  std::string address() const { return absl::StrCat("127.0.0.1:", port_); }
  int calls() const { return calls_; }

 private:
  const grpc::Status refusal_;
  int port_ = 0;
  std::atomic<int> calls_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

// Of a command that reads the status of the server at this address.
int ExitStatusAt(const std::string& address) {
  CLI::App app;
  const GlobalOptions global;
  const Action action = [&] {
    Client client({.server = address, .retry = false});
    return client.GetCatalogStatus().status();
  };
  std::string name = "graspdb";
  char* argv[] = {name.data(), nullptr};
  return RunCommandLine(app, global, action, {}, 1, argv);
}

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

TEST(Command, OnlyAServerThatDoesNotAnswerIsReportedAsMissing) {
  const RefusingServer broken(
      server::ToGrpcStatus(absl::UnavailableError("the catalogue rejects changes")));
  EXPECT_EQ(ExitStatusAt(broken.address()), 1);
  EXPECT_EQ(ExitStatusAt("127.0.0.1:1"), 3);
}

TEST(Command, AnErrorWithAnotherTextKeepsItsDetails) {
  absl::Status status = absl::UnavailableError("the catalogue rejects changes");
  status.SetPayload(kErrorDetails, absl::Cord("details"));
  const absl::Status named = WithMessage(status, "objects/mug: " + std::string(status.message()));
  EXPECT_TRUE(absl::IsUnavailable(named));
  EXPECT_EQ(named.message(), "objects/mug: the catalogue rejects changes");
  EXPECT_EQ(named.GetPayload(kErrorDetails), absl::Cord("details"));
}

TEST(Command, CallsAreSentAgainToABusyServerAsOftenAsTheFlagAllows) {
  const RefusingServer server(graspdb::testing::BusyFor(absl::Milliseconds(1)));
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
