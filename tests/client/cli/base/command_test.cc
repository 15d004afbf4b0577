#include "client/cli/base/command.h"

#include <gtest/gtest.h>

#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::client {
namespace {

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

}  // namespace
}  // namespace graspdb::client
