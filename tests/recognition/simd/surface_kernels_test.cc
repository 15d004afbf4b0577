// The SIMD kernels for surfaces against plain loops, and against each other bit by bit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <vector>

#include "recognition/points/nearest_grid.h"
#include "recognition/simd/kernels.h"
#include "recognition/simd/rigid_transform.h"
#include "recognition/simd/soa_cloud.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition::simd {
namespace {

using Eigen::Vector3d;
using ::graspdb::testing::Random;
using ::graspdb::testing::RandomMotion;
using ::graspdb::testing::Uniform;
using ::graspdb::testing::WavySurface;
using ::testing::ElementsAreArray;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr float kReach = 0.015F;
constexpr float kSpacing = 0.003F;
constexpr float kAgreement = 0.5F;
constexpr float kFacing = 0.2F;

// Sums of residuals, in doubles.
struct Sums {
  void Add(const Vector3d& arm, const Vector3d& direction, double residual, double w) {
    Vector6d row;
    row << arm.cross(direction), direction;
    hessian += w * row * row.transpose();
    gradient += w * residual * row;
    weight += w;
  }
  void AddAlong(const Vector3d& arm, const Vector3d& along, double w) {
    const double beyond = along.norm() - static_cast<double>(kSpacing);
    if (beyond > 0) Add(arm, along.normalized(), beyond, w);
  }

  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double weight = 0;
};

double Tukey(const Vector3d& d) {
  const double rest = 1 - d.squaredNorm() / static_cast<double>(kReach * kReach);
  return rest > 0 ? rest * rest : 0;
}

void ExpectNear(const NormalEquations& found, const Sums& expected) {
  const double off = 1e-4 * expected.weight;
  EXPECT_NEAR(static_cast<double>(found.weight), expected.weight, off);
  const float* next = found.hessian;
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(static_cast<double>(found.gradient[i]), expected.gradient(i), off);
    for (int j = i; j < 6; ++j) {
      EXPECT_NEAR(static_cast<double>(*next++), expected.hessian(i, j), off) << i << ' ' << j;
    }
  }
}

// A window of pixels, each different from its neighbour.
struct Window {
  static constexpr int kSide = 40;
  static constexpr int kBorder = 3;
  static constexpr int kRow = kSide + 2 * kBorder;

  explicit Window(Random& random) : depths(std::size_t{kRow} * kRow, 0) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const double kind = Uniform(random, 0, 4);
        const auto depth = static_cast<float>(Uniform(random, 0.95, 1.05));
        depths[Place(x, y)] = kind < 1 ? 0 : (kind < 2 ? -depth : depth);
      }
    }
  }
  std::size_t Place(int x, int y) const {
    return static_cast<std::size_t>(y + kBorder) * kRow + static_cast<std::size_t>(x + kBorder);
  }
  DepthWindow view(bool alone) const {
    return {&depths[Place(0, 0)], kRow, {-0.06F, -0.06F}, 300, {kSide, kSide}, alone};
  }
  // The definition, see Finding.
  enum class Kind { kThere, kHidden, kDenied, kUnmeasured };
  Kind At(const Eigen::Vector3f& p, float slant, float tolerance, float* off) const {
    const int x = static_cast<int>(std::floor((p.x() / p.z() + 0.06F) * 300));
    const int y = static_cast<int>(std::floor((p.y() / p.z() + 0.06F) * 300));
    *off = 1e9F;
    if (x < -1 || y < -1 || x > kSide || y > kSide) return Kind::kUnmeasured;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const float depth = std::abs(depths[Place(x + dx, y + dy)]);
        if (depth > 0) *off = std::min(*off, std::abs(p.z() - depth) * slant);
      }
    }
    const float center = depths[Place(x, y)];
    if (*off < tolerance) return Kind::kThere;
    if (center < 0 && (p.z() + center) * slant > tolerance) return Kind::kHidden;
    return center != 0 ? Kind::kDenied : Kind::kUnmeasured;
  }

  std::vector<float> depths;
};

// A wavy patch, and the same moved a little; both 1 m before a sensor that sees the patch from its
// upper side.
class SurfaceKernelsTest : public ::testing::TestWithParam<const Functions*> {
 protected:
  SurfaceKernelsTest() {
    sensor_.linear() = Vector3d(1, -1, -1).asDiagonal();
    sensor_.translation().z() = 1;
  }

  PointToPlaneResiduals ResidualsOf() const {
    return {.from = columns_.coordinates(),
            .to_from = RigidTransform(moved_).rigid(),
            .to = grid_.LookUpIn(cloud_),
            .center = {0.01F, 0.02F, -0.01F},
            .reach = kReach,
            .spacing = kSpacing,
            .edge_weight = 0.3F,
            .min_agreement = kAgreement};
  }

  EdgeResiduals EdgeResidualsOf(bool alone) const {
    return {.surface = columns_.coordinates(),
            .scan_surface = RigidTransform(moved_).rigid(),
            .sensor_surface = RigidTransform(Pose(sensor_ * moved_)).rigid(),
            .scan = grid_.LookUpIn(cloud_),
            .window = window_.view(alone),
            .center = {0.01F, 0.02F, -0.01F},
            .reach = kReach,
            .spacing = kSpacing,
            .min_facing = kFacing,
            .min_agreement = kAgreement};
  }

  const Functions& kernels_ = *GetParam();
  Random random_{17};
  const OrientedCloud cloud_ = WavySurface(random_, 1500);
  const NearestGrid grid_{cloud_.points, 0.003F, 0.02F};
  const SoaCloud columns_{cloud_};
  const Vector3d center_{0.01, 0.02, -0.01};
  Pose moved_ = RandomMotion(random_, Vector3d::Zero(), 0.1, 0.006);
  Pose sensor_ = Pose::Identity();  // T_sensor_patch
  const Window window_{random_};
};

TEST_P(SurfaceKernelsTest, PointsHaveResidualsToTheNearSurface) {
  Sums expected;
  for (std::size_t i = 0; i < cloud_.points.size(); ++i) {
    const Vector3d p = moved_ * cloud_.points[i].cast<double>();
    const int nearest = grid_.Nearest(p.cast<float>());
    if (nearest < 0) continue;
    const Vector3d q = cloud_.points[static_cast<std::size_t>(nearest)].cast<double>();
    const Vector3d n = cloud_.normals[static_cast<std::size_t>(nearest)].cast<double>();
    if (n.dot(moved_.linear() * cloud_.normals[i].cast<double>()) < 0.5) continue;
    const Vector3d d = p - q;
    expected.Add(q - center_, n, d.dot(n), Tukey(d));
    expected.AddAlong(q - center_, d - d.dot(n) * n, 0.3 * Tukey(d));
  }
  ASSERT_GT(expected.weight, 100);
  ExpectNear(kernels_.accumulate_point_to_plane(ResidualsOf()), expected);
}

TEST_P(SurfaceKernelsTest, ContradictedEdgesHaveResidualsAlongTheSurface) {
  for (const bool alone : {false, true}) {
    Sums expected;
    for (std::size_t i = 0; i < cloud_.points.size(); ++i) {
      const Vector3d q = moved_ * cloud_.points[i].cast<double>();
      const Vector3d n = moved_.linear() * cloud_.normals[i].cast<double>();
      const Vector3d seen = sensor_ * q;
      const double slant = -(sensor_.linear() * n).dot(seen.normalized());
      const int nearest = grid_.Nearest(q.cast<float>());
      if (slant < static_cast<double>(kFacing) || nearest < 0) continue;
      const auto at = static_cast<std::size_t>(nearest);
      const Vector3d d = cloud_.points[at].cast<double>() - q;
      if (d.norm() < static_cast<double>(kSpacing)) continue;
      if (n.dot(cloud_.normals[at].cast<double>()) < 0.5) continue;
      float off = 0;
      const Window::Kind kind =
          window_.At(seen.cast<float>(), static_cast<float>(slant), kSpacing, &off);
      const bool is_pulled =
          kind == Window::Kind::kDenied || (alone && kind == Window::Kind::kUnmeasured);
      if (is_pulled) expected.AddAlong(q - center_, d - d.dot(n) * n, Tukey(d));
    }
    ASSERT_GT(expected.weight, 10);
    ExpectNear(kernels_.accumulate_edges(EdgeResidualsOf(alone)), expected);
  }
}

TEST_P(SurfaceKernelsTest, SupportCountsPointsWithinTheTolerance) {
  constexpr double kTolerance = 0.004;
  double explained = 0;
  double squares = 0;
  double near = 0;
  for (const Eigen::Vector3f& point : cloud_.points) {
    const Vector3d p = moved_ * point.cast<double>();
    const int nearest = grid_.Nearest(p.cast<float>());
    if (nearest < 0) continue;
    const Vector3d n = cloud_.normals[static_cast<std::size_t>(nearest)].cast<double>();
    const Vector3d d = p - cloud_.points[static_cast<std::size_t>(nearest)].cast<double>();
    const double beyond = std::max(0.0, (d - d.dot(n) * n).norm() - static_cast<double>(kSpacing));
    const double squared = d.dot(n) * d.dot(n) + beyond * beyond;
    if (squared >= kTolerance * kTolerance) continue;
    explained += 1 - squared / (kTolerance * kTolerance);
    squares += squared;
    near += 1;
  }
  ASSERT_GT(near, 100);
  const Support found =
      kernels_.support(columns_.coordinates().points, RigidTransform(moved_).rigid(),
                       grid_.LookUpIn(cloud_), kSpacing, static_cast<float>(kTolerance));
  EXPECT_NEAR(static_cast<double>(found.explained), explained, 1e-3 * near);
  EXPECT_NEAR(static_cast<double>(found.squares), squares, 1e-4 * squares);
  EXPECT_EQ(static_cast<double>(found.near), near);
}

TEST_P(SurfaceKernelsTest, PointsAreConfirmedHiddenContradictedOrMissing) {
  constexpr float kTolerance = 0.008F;
  const RigidTransform seen(Pose(sensor_ * moved_));
  const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> turn(
      seen.rigid().rotation[0]);
  const std::size_t count = columns_.coordinates().points.count;
  std::vector<float> x(count);
  std::vector<float> y(count);
  std::vector<float> z(count);
  std::vector<std::uint8_t> facing(count);
  kernels_.face(columns_.coordinates(), seen.rigid(), 0.9F, x.data(), y.data(), z.data(),
                facing.data());
  double all = 0;
  double expected = 0;
  double found = 0;
  std::map<Window::Kind, double> areas;
  for (std::size_t i = 0; i < cloud_.points.size(); ++i) {
    const Eigen::Vector3f p = seen.Point(cloud_.points[i]);
    const float slant = -(turn * cloud_.normals[i]).dot(p.normalized());
    ASSERT_EQ(facing[i], slant >= 0.9F) << slant;
    if (facing[i] == 0) continue;
    float off = 0;
    const Window::Kind kind = window_.At(p, slant, kTolerance, &off);
    const auto area = static_cast<double>(slant);
    all += area;
    areas[kind] += area;
    if (kind == Window::Kind::kHidden) continue;
    expected += kind == Window::Kind::kUnmeasured ? 0.25 * area : area;
    const auto share = static_cast<double>(off / kTolerance);
    if (kind == Window::Kind::kThere) found += area * (1 - share * share);
  }
  const Seen looked = kernels_.look(columns_.coordinates(), seen.rigid(), facing.data(),
                                    window_.view(/*alone=*/true), kTolerance, 0.25F);
  ASSERT_GT(found, 10);
  EXPECT_NEAR(static_cast<double>(looked.all), all, 1e-4 * all);
  EXPECT_NEAR(static_cast<double>(looked.expected), expected, 1e-4 * all);
  EXPECT_NEAR(static_cast<double>(looked.found), found, 1e-4 * all);
  EXPECT_NEAR(static_cast<double>(looked.confirmed), areas[Window::Kind::kThere], 1e-4 * all);
  EXPECT_NEAR(static_cast<double>(looked.contradicted), areas[Window::Kind::kDenied], 1e-4 * all);
  EXPECT_NEAR(static_cast<double>(looked.unmeasured), areas[Window::Kind::kUnmeasured], 1e-4 * all);
}

TEST_P(SurfaceKernelsTest, BitsEqualThePortableFunctions) {
  const Functions& portable = Portable();
  for (int round = 0; round < 20; ++round) {
    moved_ = RandomMotion(random_, Vector3d::Zero(), 0.2, 0.01);
    const NormalEquations ours = kernels_.accumulate_point_to_plane(ResidualsOf());
    const NormalEquations theirs = portable.accumulate_point_to_plane(ResidualsOf());
    ASSERT_THAT(ours.hessian, ElementsAreArray(theirs.hessian));
    ASSERT_THAT(ours.gradient, ElementsAreArray(theirs.gradient));
    const NormalEquations edges = kernels_.accumulate_edges(EdgeResidualsOf(true));
    ASSERT_THAT(edges.hessian,
                ElementsAreArray(portable.accumulate_edges(EdgeResidualsOf(true)).hessian));
    const Rigid sensor_surface = RigidTransform(Pose(sensor_ * moved_)).rigid();
    const std::vector<std::uint8_t> all(columns_.coordinates().points.count, 1);
    const auto look = [&](const Functions& kernels) {
      return kernels.look(columns_.coordinates(), sensor_surface, all.data(), window_.view(false),
                          0.008F, 0.3F);
    };
    ASSERT_EQ(look(kernels_).expected, look(portable).expected);
    ASSERT_EQ(look(kernels_).found, look(portable).found);
    const auto support = [&](const Functions& kernels) {
      return kernels.support(columns_.coordinates().points, RigidTransform(moved_).rigid(),
                             grid_.LookUpIn(cloud_), kSpacing, 0.004F);
    };
    ASSERT_EQ(support(kernels_).explained, support(portable).explained);
  }
}

INSTANTIATE_TEST_SUITE_P(Functions, SurfaceKernelsTest, ::testing::Values(&Portable(), &Best()),
                         [](const auto& test) {
                           return test.index == 0 ? std::string("Portable") : std::string("Best");
                         });

}  // namespace
}  // namespace graspdb::recognition::simd
