#include "server/requests/request_names.h"

#include <gtest/gtest.h>

#include "graspdb/v1/catalog_service.pb.h"
#include "graspdb/v1/cell_service.pb.h"
#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::server {
namespace {

TEST(ResourceOf, IsTheNameOfWhatTheRequestReadsOrChanges) {
  v1::GetViewRequest get;
  get.set_name("objects/a/stablePoses/b/views/c");
  EXPECT_EQ(ResourceOf(get), "objects/a/stablePoses/b/views/c");
  v1::UpdateObjectRequest update;
  update.mutable_object()->set_name("objects/a");
  EXPECT_EQ(ResourceOf(update), "objects/a");
  v1::CreateObjectRequest object;
  object.set_object_id("a");
  EXPECT_EQ(ResourceOf(object), "objects/a");
  v1::CreateStablePoseRequest pose;
  pose.set_parent("objects/a");
  pose.set_stable_pose_id("b");
  EXPECT_EQ(ResourceOf(pose), "objects/a/stablePoses/b");
  v1::ReportGraspOutcomeRequest report;
  report.set_name("objects/a/stablePoses/b");
  report.set_grasp_id("top");
  EXPECT_EQ(ResourceOf(report), "objects/a/stablePoses/b");
  v1::ListViewsRequest list;
  list.set_parent("objects/a/stablePoses/b");
  EXPECT_EQ(ResourceOf(list), "objects/a/stablePoses/b");
  v1::ProposeThresholdsRequest thresholds;
  thresholds.set_object("objects/a");
  EXPECT_EQ(ResourceOf(thresholds), "objects/a");
  EXPECT_EQ(ResourceOf(v1::ListObjectsRequest()), "");
}

TEST(CellOf, IsTheCellThatTheRequestUses) {
  v1::RecognizeRequest recognize;
  EXPECT_EQ(CellOf(recognize), "");
  recognize.set_cell("cells/c");
  EXPECT_EQ(CellOf(recognize), "cells/c");
  v1::CreateCellRequest creation;
  creation.set_cell_id("c");
  creation.mutable_cell()->set_name("cells/ignored");
  EXPECT_EQ(CellOf(creation), "cells/c");
  v1::UpdateCellRequest update;
  update.mutable_cell()->set_name("cells/c");
  EXPECT_EQ(CellOf(update), "cells/c");
  v1::DeleteCellRequest deletion;
  deletion.set_name("cells/c");
  EXPECT_EQ(CellOf(deletion), "cells/c");
  v1::GetObjectRequest object;
  object.set_name("objects/a");
  EXPECT_EQ(CellOf(object), std::nullopt);
}

}  // namespace
}  // namespace graspdb::server
