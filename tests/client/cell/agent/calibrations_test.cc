#include "client/cell/agent/calibrations.h"

#include <gmock/gmock.h>

#include "tests/client/cell/agent/fake_camera.h"
#include "tests/client/cell/agent/scripted_server.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::HasSubstr;

constexpr char kCell[] = "cells/press-3";

TEST(ParseCalibrations, ParsesAllWords) {
  const auto configs = ParseCalibrations(
      {"0 target=block", "3 target=objects/cup mount=flange frames=9", "4 target=block region=0.3"},
      kCell);
  ASSERT_THAT(configs, IsOk());
  ASSERT_EQ(configs->size(), 3U);
  EXPECT_EQ((*configs)[0].pipeline, 0);
  EXPECT_EQ((*configs)[0].setup.cell, kCell);
  EXPECT_EQ((*configs)[0].setup.target, "objects/block");
  EXPECT_EQ((*configs)[0].setup.mount, CameraMount::kFixed);
  EXPECT_EQ((*configs)[1].pipeline, 3);
  EXPECT_EQ((*configs)[1].setup.target, "objects/cup");
  EXPECT_EQ((*configs)[1].setup.mount, CameraMount::kOnFlange);
  EXPECT_EQ((*configs)[1].setup.frames, 9);
  EXPECT_FALSE((*configs)[0].setup.region);
  ASSERT_TRUE((*configs)[2].setup.region);
  EXPECT_EQ((*configs)[2].setup.region->min, Eigen::Vector3d(-0.3, -0.3, 0.06));
  EXPECT_EQ((*configs)[2].setup.region->max, Eigen::Vector3d(0.3, 0.3, 0.5));
}

TEST(ParseCalibrations, InvalidLinesAreRejectedWithTheLine) {
  for (const char* line :
       {"", "block", "-1 target=block", "0 mount=fixed", "0 target=", "0 target=block mount=wall",
        "0 target=block frames=0", "0 target=block region=3", "0 target=block region=nan",
        "0 target=block region=0.3 mount=flange"}) {
    EXPECT_THAT(ParseCalibrations({line}, kCell),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(line)))
        << line;
  }
  EXPECT_THAT(ParseCalibrations({"0 target=a", "0 target=b"}, kCell),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("taken")));
}

TEST(Calibrations, HasTheConfiguredPipelines) {
  ScriptedServer server;
  Client client = server.Connect();
  FakeCamera camera([] { return absl::UnavailableError("unplugged"); });
  CellCache cell(client, kCell, absl::Hours(1));
  Calibrations calibrations(*ParseCalibrations({"2 target=block"}, kCell), client, camera, cell);
  EXPECT_THAT(calibrations.Check(2), IsOk());
  EXPECT_THAT(calibrations.Check(0), StatusIs(absl::StatusCode::kNotFound));
  EXPECT_THAT(calibrations.Calibrate(2), StatusIs(absl::StatusCode::kAborted));  // no Init before
}

}  // namespace
}  // namespace graspdb::client
