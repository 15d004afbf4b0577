// Point pairs of a model, and how it looks from its sides.
#include "recognition/pairs/pair_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <optional>

#include "recognition/pairs/pair_votes.h"

namespace graspdb::recognition {
namespace {

// All six faces of a box, points 3 mm apart, and a knob on one of them.
OrientedCloud KnobbedBox() {
  OrientedCloud out;
  const auto add = [&](const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
    constexpr float kStep = 0.003F;
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3;
      const int v = (axis + 2) % 3;
      for (float a = low[u]; a <= high[u]; a += kStep) {
        for (float b = low[v]; b <= high[v]; b += kStep) {
          for (const float side : {-1.0F, 1.0F}) {
            Eigen::Vector3f p;
            p[axis] = side < 0 ? low[axis] : high[axis];
            p[u] = a;
            p[v] = b;
            out.points.push_back(p);
            out.normals.push_back(side * Eigen::Vector3f::Unit(axis));
          }
        }
      }
    }
  };
  add({-0.06F, -0.04F, -0.02F}, {0.06F, 0.04F, 0.02F});
  add({0.02F, 0.01F, 0.02F}, {0.05F, 0.03F, 0.05F});
  return out;
}

// The points that a camera straight above sees, moved by `scene_model`.
OrientedCloud SeenFromAbove(const PairModel& model, const Eigen::Isometry3f& scene_model) {
  const ModelAspect aspect = model.AspectSeenFrom(model.center + Eigen::Vector3f(0, 0, 0.8F), 64);
  OrientedCloud out;
  for (std::size_t i = 0; i < aspect.visible.size(); i += 3) {
    out.points.push_back(scene_model * model.surface.points[aspect.visible[i]]);
    out.normals.push_back(scene_model.linear() * model.surface.normals[aspect.visible[i]]);
  }
  return out;
}

TEST(PairModelTest, OnlyTheSideTowardsTheCameraIsVisible) {
  const auto model = MakePairModel(KnobbedBox(), {});
  ASSERT_NE(model, nullptr);
  const ModelAspect aspect = model->AspectSeenFrom(model->center + Eigen::Vector3f(0, 0, 0.8F), 64);
  ASSERT_GT(aspect.visible.size(), 100U);
  for (const std::uint16_t i : aspect.visible) EXPECT_GT(model->surface.normals[i].z(), 0.1F);
}

TEST(PairModelTest, TheOutlineLeadsOffTheObject) {
  const auto model = MakePairModel(KnobbedBox(), {});
  ASSERT_NE(model, nullptr);
  const ModelAspect aspect = model->AspectSeenFrom(model->center + Eigen::Vector3f(0, 0, 0.8F), 64);
  ASSERT_GT(aspect.outline.size(), 30U);
  for (std::size_t k = 0; k < aspect.outline.size(); ++k) {
    const Eigen::Vector3f& p = aspect.outline[k];
    EXPECT_TRUE(std::abs(p.x()) > 0.045F || std::abs(p.y()) > 0.025F) << p.transpose();
    const Eigen::Vector2f way = aspect.outward[k].head<2>();
    EXPECT_GT(way.dot(p.head<2>()), 0) << p.transpose();
  }
}

TEST(PairModelTest, EveryPairOfTheModelIsFound) {
  const auto model = MakePairModel(KnobbedBox(), {});
  ASSERT_NE(model, nullptr);
  const auto& [points, normals] = model->points;
  std::size_t found = 0;
  std::size_t tried = 0;
  for (std::size_t i = 0; i < points.size(); i += 7) {
    for (std::size_t j = 0; j < points.size(); j += 11) {
      if ((points[i] - points[j]).norm() < 0.02F) continue;
      tried += 1;
      const auto feature = FeatureOf(points[i], normals[i], points[j], normals[j]);
      for (const auto& entry : model->table->Find(feature.value())) {
        if (entry.point == i) {
          found += 1;
          break;
        }
      }
    }
  }
  // Buckets with too many pairs are empty.
  EXPECT_GT(found, tried / 2);
}

VotedPoses PosesVotedFor(const PairModel& model, const OrientedCloud& scene,
                         const std::optional<Voting::Upright>& upright = std::nullopt) {
  const Voting models[] = {{&model, upright}};
  return VoteForPoses(models, scene, {}, [] { return false; }).front();
}

TEST(PairVotesTest, APoseIsFoundWhereTheModelIs) {
  const auto model = MakePairModel(KnobbedBox(), {});
  ASSERT_NE(model, nullptr);
  Eigen::Isometry3f truth = Eigen::Isometry3f::Identity();
  truth.linear() = (Eigen::AngleAxisf(0.7F, Eigen::Vector3f::UnitZ()) *
                    Eigen::AngleAxisf(0.4F, Eigen::Vector3f::UnitX()))
                       .toRotationMatrix();
  truth.translation() = Eigen::Vector3f(0.1F, -0.05F, 0.7F);
  const OrientedCloud scene = SeenFromAbove(*model, truth);
  std::size_t near = 0;
  for (const auto& pose : PosesVotedFor(*model, scene)) {
    const Eigen::AngleAxisf turn(Eigen::Matrix3f(truth.linear().transpose() * pose.linear()));
    if ((truth.inverse() * pose).translation().norm() < 0.015F && std::abs(turn.angle()) < 0.3F) {
      near += 1;
    }
  }
  EXPECT_GT(near, 5U);
}

// A box upside down looks like one that stands.
TEST(PairVotesTest, PosesThatDoNotStandUprightAreLeftOut) {
  OrientedCloud box = KnobbedBox();
  const std::size_t count = box.points.size();
  for (std::size_t i = 0; i < count; ++i) {
    box.points.push_back({-box.points[i].x(), box.points[i].y(), -box.points[i].z()});
    box.normals.push_back({-box.normals[i].x(), box.normals[i].y(), -box.normals[i].z()});
  }
  const auto model = MakePairModel(box, {});
  ASSERT_NE(model, nullptr);
  const OrientedCloud scene = SeenFromAbove(*model, Eigen::Isometry3f::Identity());
  const auto upright = [](const Eigen::Isometry3f& pose) { return pose.linear()(2, 2) >= 0.9F; };
  EXPECT_FALSE(std::ranges::all_of(PosesVotedFor(*model, scene), upright));
  const VotedPoses standing =
      PosesVotedFor(*model, scene, Voting::Upright{Eigen::Vector3f::UnitZ(), 0.9F});
  EXPECT_GT(standing.size(), 20U);
  EXPECT_TRUE(std::ranges::all_of(standing, upright));
}

TEST(PairVotesTest, TheSameVotesGiveTheSamePoses) {
  const auto model = MakePairModel(KnobbedBox(), {});
  ASSERT_NE(model, nullptr);
  const OrientedCloud scene = SeenFromAbove(*model, Eigen::Isometry3f::Identity());
  const auto a = PosesVotedFor(*model, scene);
  const auto b = PosesVotedFor(*model, scene);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].matrix(), b[i].matrix());
}

TEST(PairVotesTest, EachOfSeveralModelsGetsThePosesThatItGetsAlone) {
  const OrientedCloud box = KnobbedBox();
  OrientedCloud half = box;
  for (Eigen::Vector3f& p : half.points) p *= 0.5F;
  const auto large = MakePairModel(box, {});
  const auto small = MakePairModel(half, {});
  ASSERT_NE(large, nullptr);
  ASSERT_NE(small, nullptr);
  const OrientedCloud scene = SeenFromAbove(*large, Eigen::Isometry3f::Identity());
  const Voting models[] = {{small.get()}, {large.get()}};
  const auto together = VoteForPoses(models, scene, {}, [] { return false; });
  for (std::size_t m = 0; m < 2; ++m) {
    const VotedPoses alone = PosesVotedFor(*models[m].model, scene);
    EXPECT_FALSE(alone.empty());
    ASSERT_EQ(together[m].size(), alone.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
      EXPECT_EQ(together[m][i].matrix(), alone[i].matrix());
    }
  }
}

TEST(PairModelTest, PartsFarApartDoNotFillTheMemory) {
  OrientedCloud cloud = KnobbedBox();
  const std::size_t count = cloud.points.size();
  for (std::size_t i = 0; i < count; ++i) {
    cloud.points.push_back(cloud.points[i] + Eigen::Vector3f(90, 0, 0));
    cloud.normals.push_back(cloud.normals[i]);
  }
  const auto model = MakePairModel(cloud, {});
  if (model == nullptr) return;  // thinned to a few points
  EXPECT_LT(model->bytes(), 16'000'000U);
  // Nor does a camera in the middle of an object.
  EXPECT_LE(model->AspectSeenFrom(model->center, 64).visible.size(), model->surface.points.size());
}

TEST(PairModelTest, ThereIsNoModelOfAFewPoints) {
  EXPECT_EQ(MakePairModel({}, {}), nullptr);
  OrientedCloud few;
  for (int i = 0; i < 5; ++i) {
    few.points.emplace_back(0.01F * static_cast<float>(i), 0, 0);
    few.normals.emplace_back(0, 0, 1);
  }
  EXPECT_EQ(MakePairModel(few, {}), nullptr);
}

}  // namespace
}  // namespace graspdb::recognition
