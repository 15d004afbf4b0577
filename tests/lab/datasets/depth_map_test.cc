#include "lab/datasets/depth_map.h"

#include <gmock/gmock.h>

#include "tests/files/temporary_folder.h"
#include "tests/lab/datasets/hdf5_writer.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;
using ::testing::HasSubstr;

constexpr DepthLens kPinhole = {.fx = 570, .fy = 572, .cx = 315, .cy = 243};

// The pixel at which the camera sees the direction x / z, y / z.
Eigen::Vector2d PixelOf(const DepthLens& lens, double x, double y) {
  const auto& [k1, k2, p1, p2, k3] = lens.distortion;
  const double r2 = x * x + y * y;
  const double radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
  return {lens.cx + lens.fx * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)),
          lens.cy + lens.fy * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y)};
}

TEST(DepthLens, TheDistortionIsTakenOff) {
  DepthLens lens = kPinhole;
  lens.distortion = {-0.09, 0.25, 0.001, -0.002, -0.12};
  for (const double x : {-0.5, -0.1, 0.0, 0.3, 0.55}) {
    for (const double y : {-0.4, 0.0, 0.2, 0.4}) {
      const Eigen::Vector2d seen = DirectionOf(lens, PixelOf(lens, x, y));
      EXPECT_NEAR(seen.x(), x, 1e-4) << x << ", " << y;
      EXPECT_NEAR(seen.y(), y, 1e-4) << x << ", " << y;
    }
  }
}

TEST(DepthMap, PixelsBecomePointsBeforeTheCamera) {
  const TemporaryFolder folder;
  std::vector<std::uint16_t> depth(std::size_t{640} * 480, 0);
  depth[100 * 640 + 600] = 8000;
  Hdf5Writer(folder.path() / "NP1_0.h5").Add("depth", 480, 640, depth);
  DepthLens lens = kPinhole;
  lens.step_m = 1.01e-4;
  const auto points = ReadDepthMap(folder.path() / "NP1_0.h5", lens);
  ASSERT_THAT(points, IsOk());
  const double z = 0.808;
  const Eigen::Vector3f wanted =
      Eigen::Vector3d((600 - lens.cx) / lens.fx * z, (100 - lens.cy) / lens.fy * z, z)
          .cast<float>();
  ASSERT_EQ(points->size(), depth.size());
  EXPECT_TRUE((*points)[100 * 640 + 600].isApprox(wanted, 1e-5F));
  EXPECT_TRUE((*points)[0].array().isNaN().all());
}

TEST(DepthMap, AnotherSizeIsRefused) {
  const TemporaryFolder folder;
  const std::vector<std::uint16_t> depth(std::size_t{320} * 240, 0);
  Hdf5Writer(folder.path() / "NP1_0.h5").Add("depth", 240, 320, depth);
  EXPECT_THAT(ReadDepthMap(folder.path() / "NP1_0.h5", kPinhole),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("it must be 480 x 640")));
}

}  // namespace
}  // namespace graspdb::client
