#include <gmock/gmock.h>

#include <array>

#include "graspdb/v1/cell.pb.h"
#include "server/requests/record_checks.h"
#include "tests/server/error_details.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::server {
namespace {

using testing::IsOk;

constexpr std::array<std::string_view, 2> kFields = {"display_name", "pipeline"};

v1::Cell CellOf(const std::string& display_name, double min_score) {
  v1::Cell cell;
  cell.set_name("cells/" + display_name);
  cell.set_display_name(display_name);
  cell.mutable_pipeline()->set_min_score(min_score);
  cell.mutable_pipeline()->set_icp_iteration_count(7);
  return cell;
}

absl::Status Apply(const v1::Cell& from, const std::vector<std::string>& paths, v1::Cell* to) {
  google::protobuf::FieldMask mask;
  for (const std::string& path : paths) mask.add_paths(path);
  return ApplyUpdate(from, mask, kFields, to);
}

TEST(UpdateMask, OnlyMaskedFieldsAreCopied) {
  v1::Cell cell = CellOf("old", 0.1);
  ASSERT_THAT(Apply(CellOf("new", 0.2), {"pipeline"}, &cell), IsOk());
  EXPECT_EQ(cell.display_name(), "old");
  EXPECT_EQ(cell.pipeline().min_score(), 0.2);
}

TEST(UpdateMask, EmptyMaskCopiesAllMutableFields) {
  v1::Cell cell = CellOf("old", 0.1);
  ASSERT_THAT(Apply(CellOf("new", 0.2), {}, &cell), IsOk());
  EXPECT_EQ(cell.display_name(), "new");
  EXPECT_EQ(cell.name(), "cells/old");
}

TEST(UpdateMask, AMaskedMessageIsReplacedAsAWhole) {
  v1::Cell from;
  from.mutable_pipeline()->set_min_score(0.2);
  v1::Cell cell = CellOf("old", 0.1);
  ASSERT_THAT(Apply(from, {"pipeline"}, &cell), IsOk());
  EXPECT_FALSE(cell.pipeline().has_icp_iteration_count());
}

TEST(UpdateMask, APathIntoAMessageChangesThatFieldOnly) {
  v1::Cell cell = CellOf("old", 0.1);
  ASSERT_THAT(Apply(CellOf("new", 0.2), {"pipeline.min_score"}, &cell), IsOk());
  EXPECT_EQ(cell.pipeline().min_score(), 0.2);
  EXPECT_EQ(cell.display_name(), "old");
}

TEST(UpdateMask, OtherPathsAreRejectedAndNothingIsCopied) {
  for (const char* path :
       {"name", "etag", "nonsense", "pipeline.nonsense", "Pipeline", "", "*", "display_name.x"}) {
    v1::Cell cell = CellOf("old", 0.1);
    const absl::Status status = Apply(CellOf("new", 0.2), {"display_name", path}, &cell);
    testing::ExpectBadField(ToGrpcStatus(status), "update_mask",
                            "\"" + std::string(path) + "\" is not a field that can be changed");
    EXPECT_EQ(cell.display_name(), "old");
  }
}

}  // namespace
}  // namespace graspdb::server
