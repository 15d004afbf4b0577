// Invalid cells: each is rejected with its field and a sentence, and changes nothing.
#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <ostream>

#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct BadCell {
  std::string name;
  std::function<void(v1::Cell&)> fill;
  std::string field;
  std::string words;
};

void PrintTo(const BadCell& bad, std::ostream* out) { *out << bad.name; }

class BadCellTest : public ServerTest, public ::testing::WithParamInterface<BadCell> {};

TEST_P(BadCellTest, IsRejectedWithASentenceAndChangesNothing) {
  const std::int64_t revision = Status().catalog_revision();
  v1::CreateCellRequest request;
  request.set_cell_id("new");
  GetParam().fill(*request.mutable_cell());
  ExpectBadField(Call(&Cells::CreateCell, request), "cell." + GetParam().field, GetParam().words);
  EXPECT_EQ(Status().catalog_revision(), revision);
}

std::string NameOf(const ::testing::TestParamInfo<BadCell>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(
    All, BadCellTest,
    ::testing::Values(
        BadCell{"CellWithInfinitePosition",
                [](v1::Cell& c) {
                  c.mutable_sensor_pose()->mutable_orientation()->set_w(1);
                  c.mutable_sensor_pose()->mutable_position()->set_x(kInfinity);
                },
                "sensor_pose.position", "finite"},
        BadCell{"CellWithUnnormalisedRotation",
                [](v1::Cell& c) { c.mutable_sensor_pose()->mutable_orientation()->set_w(0.99); },
                "sensor_pose.orientation", "0.99"},
        BadCell{"CellWithUnnormalisedBase",
                [](v1::Cell& c) { c.mutable_robot_base_pose()->mutable_orientation()->set_w(2); },
                "robot_base_pose.orientation", "2"},
        BadCell{
            "CellWithUnnormalisedMount",
            [](v1::Cell& c) { c.mutable_flange_sensor_pose()->mutable_orientation()->set_w(2); },
            "flange_sensor_pose.orientation", "2"},
        BadCell{"CellWithRegionUpsideDown",
                [](v1::Cell& c) {
                  *c.mutable_region_of_interest() = BoxMessage({0, 0, 1}, {1, 1, 0});
                },
                "region_of_interest", "is empty"},
        BadCell{"CellWithPipelineOutOfRange",
                [](v1::Cell& c) { c.mutable_pipeline()->set_verified_view_count(0); },
                "pipeline.verified_view_count", "1 to 100"}),
    NameOf);

}  // namespace
}  // namespace graspdb::testing
