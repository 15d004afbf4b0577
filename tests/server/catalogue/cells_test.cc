// Cells through the CellService.
#include <gmock/gmock.h>

#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

using ::testing::ElementsAre;

class CellsTest : public ServerTest {
 protected:
  static v1::Cell FullCell() {
    v1::Cell cell;
    cell.set_display_name("Press 3");
    cell.mutable_sensor_pose()->mutable_position()->set_z(0.8);
    cell.mutable_sensor_pose()->mutable_orientation()->set_x(1);
    *cell.mutable_region_of_interest() = BoxMessage({-0.3, -0.3, 0}, {0.3, 0.3, 0.4});
    *cell.mutable_workspace() = BoxMessage({-0.5, -0.5, 0}, {0.5, 0.5, 0.6});
    cell.mutable_pipeline()->set_min_score(0.7);
    cell.mutable_pipeline()->set_icp_iteration_count(20);
    return cell;
  }

  grpc::Status Create(const std::string& id, const v1::Cell& cell, v1::Cell* made) {
    v1::CreateCellRequest request;
    request.set_cell_id(id);
    *request.mutable_cell() = cell;
    return Call(&Cells::CreateCell, request, made);
  }

  grpc::Status Get(const std::string& name, v1::Cell* cell) {
    v1::GetCellRequest request;
    request.set_name(name);
    return Call(&Cells::GetCell, request, cell);
  }

  grpc::Status Update(const v1::Cell& cell, const std::vector<std::string>& mask,
                      v1::Cell* updated) {
    v1::UpdateCellRequest request;
    *request.mutable_cell() = cell;
    for (const std::string& path : mask) request.mutable_update_mask()->add_paths(path);
    return Call(&Cells::UpdateCell, request, updated);
  }

  grpc::Status Delete(const std::string& name, const std::string& etag) {
    v1::DeleteCellRequest request;
    request.set_name(name);
    request.set_etag(etag);
    return Call(&Cells::DeleteCell, request);
  }
};

TEST_F(CellsTest, CreatedCellIsReadBack) {
  v1::Cell made;
  ASSERT_THAT(Create("press-3", FullCell(), &made), IsGrpcOk());
  EXPECT_EQ(made.name(), "cells/press-3");
  v1::Cell read;
  ASSERT_THAT(Get("cells/press-3", &read), IsGrpcOk());
  EXPECT_EQ(read.SerializeAsString(), made.SerializeAsString());
  EXPECT_EQ(read.pipeline().min_score(), 0.7);
  EXPECT_FALSE(read.pipeline().has_plane_distance_m());
}

TEST_F(CellsTest, ATakenIdIsAnErrorAndAMissingCellIsNotFound) {
  v1::Cell cell;
  ASSERT_THAT(Create("press-3", FullCell(), &cell), IsGrpcOk());
  ExpectError(Create("press-3", FullCell(), &cell), grpc::StatusCode::ALREADY_EXISTS,
              "cells/press-3");
  ExpectError(Get("cells/press-4", &cell), grpc::StatusCode::NOT_FOUND, "cells/press-4");
  ExpectError(Delete("cells/press-4", ""), grpc::StatusCode::NOT_FOUND, "cells/press-4");
}

TEST_F(CellsTest, MaskedUpdateClearsAnUnsetField) {
  v1::Cell cell;
  ASSERT_THAT(Create("press-3", FullCell(), &cell), IsGrpcOk());
  v1::Cell change;
  change.set_name("cells/press-3");
  v1::Cell updated;
  ASSERT_THAT(Update(change, {"workspace"}, &updated), IsGrpcOk());
  EXPECT_FALSE(updated.has_workspace());
  EXPECT_TRUE(updated.has_region_of_interest());
  EXPECT_EQ(updated.display_name(), "Press 3");
}

TEST_F(CellsTest, MaskCanSelectOnePipelineSetting) {
  v1::Cell cell;
  ASSERT_THAT(Create("press-3", FullCell(), &cell), IsGrpcOk());
  v1::Cell change;
  change.set_name("cells/press-3");
  change.mutable_pipeline()->set_min_score(0.9);
  v1::Cell updated;
  ASSERT_THAT(Update(change, {"pipeline.min_score"}, &updated), IsGrpcOk());
  EXPECT_EQ(updated.pipeline().min_score(), 0.9);
  EXPECT_EQ(updated.pipeline().icp_iteration_count(), 20);
}

TEST_F(CellsTest, InvalidSettingsAreRejectedWithTheirField) {
  v1::Cell cell = FullCell();
  v1::Cell made;
  cell.mutable_pipeline()->set_min_score(1.5);
  ExpectBadField(Create("press-3", cell, &made), "cell.pipeline.min_score", "must lie in 0 to 1");
  cell = FullCell();
  *cell.mutable_workspace() = BoxMessage({0, 0, 1}, {1, 1, 1});
  ExpectBadField(Create("press-3", cell, &made), "cell.workspace", "is empty");
  cell = FullCell();
  *cell.mutable_region_of_interest() = BoxMessage({0, 0, std::nan("")}, {1, 1, 1});
  ExpectBadField(Create("press-3", cell, &made), "cell.region_of_interest", "finite");
  cell = FullCell();
  cell.mutable_sensor_pose()->mutable_orientation()->set_x(0.5);
  ExpectBadField(Create("press-3", cell, &made), "cell.sensor_pose.orientation", "unit quaternion");
  EXPECT_EQ(Status().catalog_revision(), 0);
}

TEST_F(CellsTest, AStaleEtagAbortsTheWrite) {
  v1::Cell stale;
  ASSERT_THAT(Create("press-3", FullCell(), &stale), IsGrpcOk());
  v1::Cell fresh;
  ASSERT_THAT(Update(stale, {"display_name"}, &fresh), IsGrpcOk());
  v1::Cell ignored;
  ExpectError(Update(stale, {"display_name"}, &ignored), grpc::StatusCode::ABORTED, stale.name());
  ExpectError(Delete(stale.name(), stale.etag()), grpc::StatusCode::ABORTED, stale.name());
  EXPECT_THAT(Delete(stale.name(), fresh.etag()), IsGrpcOk());
  ExpectError(Get(stale.name(), &ignored), grpc::StatusCode::NOT_FOUND, stale.name());
}

TEST_F(CellsTest, CellsAreListedInPages) {
  v1::Cell made;
  for (const char* id : {"c", "a", "b"}) ASSERT_THAT(Create(id, FullCell(), &made), IsGrpcOk());
  std::vector<std::string> names;
  v1::ListCellsRequest request;
  request.set_page_size(2);
  v1::ListCellsResponse page;
  do {
    request.set_page_token(page.next_page_token());
    page.Clear();
    ASSERT_THAT(Call(&Cells::ListCells, request, &page), IsGrpcOk());
    for (const v1::Cell& cell : page.cells()) names.push_back(cell.name());
  } while (!page.next_page_token().empty());
  EXPECT_THAT(names, ElementsAre("cells/a", "cells/b", "cells/c"));
}

}  // namespace
}  // namespace graspdb::testing
