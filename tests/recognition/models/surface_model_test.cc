#include "recognition/models/surface_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

#include "recognition/points/point_search.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Moved;
using ::graspdb::testing::Random;
using ::graspdb::testing::RandomPose;
using ::graspdb::testing::Uniform;
using ::graspdb::testing::WavySurface;

PosedCloud View(const OrientedCloud& object, const Pose& world_object) {
  return {std::make_shared<const OrientedCloud>(Moved(world_object, object)), world_object};
}

TEST(FuseViews, ViewsFromAnywhereLieOnOneSurface) {
  Random random(1);
  const OrientedCloud object = WavySurface(random, 20'000);
  std::vector<PosedCloud> views;
  views.reserve(8);
  for (int i = 0; i < 8; ++i) views.push_back(View(object, RandomPose(random, 0.5)));
  const auto model = FuseViews(views);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->view_count, 8);
  EXPECT_LT(model->fine.cloud.points.size(), object.points.size() / 4);
  const PointSearch search(object.points);
  for (std::size_t i = 0; i < model->fine.cloud.points.size(); ++i) {
    const Neighbor nearest = search.Nearest(model->fine.cloud.points[i]);
    EXPECT_LT(nearest.squared_distance, 0.002F * 0.002F);
    EXPECT_GT(
        model->fine.cloud.normals[i].dot(object.normals[static_cast<std::size_t>(nearest.index)]),
        0.8F);
  }
}

TEST(FuseViews, PointsOfOneOfManyViewsAreNoise) {
  Random random(2);
  const OrientedCloud object = WavySurface(random, 5000);
  std::vector<PosedCloud> views(7, View(object, Pose::Identity()));
  OrientedCloud with_ghost = object;
  with_ghost.points.emplace_back(0, 0, 0.3F);
  with_ghost.normals.emplace_back(0, 0, 1);
  views.push_back(View(with_ghost, Pose::Identity()));
  const auto model = FuseViews(views);
  ASSERT_TRUE(model);
  for (const auto& p : model->fine.cloud.points) EXPECT_LT(p.z(), 0.1F);
  // A single view is kept completely.
  const auto alone = FuseViews(std::span(views).last(1));
  ASSERT_TRUE(alone);
  EXPECT_GT(alone->radius_m, 0.1F);
}

// Distances from the surface of the points of a model from eight noisy views, m.
struct OffSurface {
  double mean = 0;
  double rms = 0;
};

template <typename Surface, typename Distance>
OffSurface OffFusedSurface(const Surface& at, const Distance& distance) {
  Random random(3);
  std::normal_distribution<float> noise(0, 0.0012F);
  std::vector<PosedCloud> views;
  for (int view = 0; view < 8; ++view) {
    OrientedCloud seen;
    for (int i = 0; i < 4000; ++i) {
      const auto [p, n] = at(Uniform(random, -1, 1), Uniform(random, -1, 1));
      seen.points.push_back(p + noise(random) * n);
      seen.normals.push_back(n);
    }
    views.push_back(View(seen, Pose::Identity()));
  }
  const auto model = FuseViews(views);
  OffSurface out;
  if (model == nullptr) {
    ADD_FAILURE() << "no model from eight views";
    return out;
  }
  const auto count = static_cast<double>(model->fine.cloud.points.size());
  for (const Eigen::Vector3f& p : model->fine.cloud.points) {
    const auto off = static_cast<double>(distance(p));
    out.mean += off / count;
    out.rms += off * off / count;
  }
  out.rms = std::sqrt(out.rms);
  return out;
}

TEST(FuseViews, NoiseOverTheEdgeOfACellLeavesNoTwoLayers) {
  const auto plane = [](double u, double v) {
    return std::pair(Eigen::Vector3f(static_cast<float>(u * 0.03), static_cast<float>(v * 0.03), 0),
                     Eigen::Vector3f(0, 0, 1));
  };
  const OffSurface off = OffFusedSurface(plane, [](const Eigen::Vector3f& p) { return p.z(); });
  EXPECT_NEAR(off.mean, 0, 1e-4);
  EXPECT_LT(off.rms, 0.0003);
}

TEST(FuseViews, ARoundObjectKeepsItsRadius) {
  static constexpr float kRadiusM = 0.008F;
  const auto rod = [](double u, double v) {
    const auto angle = static_cast<float>(u * M_PI);
    const Eigen::Vector3f n(std::cos(angle), std::sin(angle), 0);
    const Eigen::Vector3f along(0, 0, static_cast<float>(v * 0.03));
    return std::pair<Eigen::Vector3f, Eigen::Vector3f>(kRadiusM * n + along, n);
  };
  const OffSurface off =
      OffFusedSurface(rod, [](const Eigen::Vector3f& p) { return p.head<2>().norm() - kRadiusM; });
  EXPECT_NEAR(off.mean, 0, 1e-4);
  EXPECT_LT(off.rms, 0.0004);
}

TEST(FuseViews, TheTwoSidesOfASheetStayApart) {
  OrientedCloud sheet;
  for (int i = 0; i < 400; ++i) {
    const int row = i / 20;
    const float x = 0.001F * static_cast<float>(i % 20);
    const float y = 0.001F * static_cast<float>(row);
    sheet.points.emplace_back(x, y, 0.0005F);
    sheet.normals.emplace_back(0, 0, 1);
    sheet.points.emplace_back(x, y, 0.0001F);
    sheet.normals.emplace_back(0, 0, -1);
  }
  const auto model = FuseViews(std::vector<PosedCloud>{View(sheet, Pose::Identity())});
  ASSERT_TRUE(model);
  std::size_t up = 0;
  for (const auto& n : model->fine.cloud.normals) {
    EXPECT_NEAR(std::abs(n.z()), 1, 1e-5);
    up += n.z() > 0;
  }
  EXPECT_EQ(2 * up, model->fine.cloud.normals.size());
}

TEST(FuseViews, NoViewsGiveNoModel) {
  EXPECT_FALSE(FuseViews({}));
  EXPECT_FALSE(FuseViews(std::vector<PosedCloud>{View({}, Pose::Identity())}));
}

}  // namespace
}  // namespace graspdb::recognition
