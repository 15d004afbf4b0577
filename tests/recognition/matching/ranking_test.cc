// Hypotheses that are as good as the best one.
#include "recognition/matching/ranking.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/recognition/scenes/taught_shapes.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::TaughtShapes;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// A plate of 12 x 8 cm.
SurfaceModel Plate() {
  OrientedCloud cloud;
  for (int row = 0; row < 41; ++row) {
    for (int column = 0; column < 61; ++column) {
      cloud.points.emplace_back(0.002F * static_cast<float>(column - 30),
                                0.002F * static_cast<float>(row - 20), 0);
      cloud.normals.emplace_back(0, 0, 1);
    }
  }
  return {cloud, 1};
}

Pose Turn(double deg) {
  return Pose(Eigen::AngleAxisd(deg * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
}

TEST(LargestGap, IsZeroForATurnByASymmetry) {
  const SurfaceModel plate = Plate();
  EXPECT_LT(LargestGap(plate, Turn(10), plate, Turn(190)), 0.003);
}

TEST(LargestGap, IsThatOfTheFarthestPoint) {
  const SurfaceModel plate = Plate();
  Pose moved = Turn(10);
  moved.translation().z() = 0.012;
  EXPECT_NEAR(LargestGap(plate, Turn(10), plate, moved), 0.012, 0.002);
  EXPECT_GE(LargestGap(plate, Turn(0), plate, Turn(90)), 0.019);
  moved.translation().z() = 0.2;
  EXPECT_GE(LargestGap(plate, Turn(10), plate, moved), 0.2);
}

// TaughtShapes, and the tower once more under another name.
class Twins : public ViewClouds {
 public:
  Twins() : snapshot_(taught_.snapshot()) {
    auto poses = *snapshot_.stable_poses;
    const TaughtStablePose tower = *poses.at("objects/tower/stablePoses/upright");
    auto twin = std::make_shared<TaughtStablePose>(tower);
    twin->name = "objects/twin/stablePoses/upright";
    twin->views.clear();
    for (const auto& view : tower.views) {
      auto copy = std::make_shared<TaughtView>(*view);
      copy->object = "objects/twin";
      copy->stable_pose = twin->name;
      copy->name = twin->name + view->name.substr(tower.name.size());
      twin->views.push_back(std::move(copy));
    }
    poses[twin->name] = std::move(twin);
    snapshot_.stable_poses = std::make_shared<const decltype(poses)>(std::move(poses));
  }

  const CatalogueSnapshot& snapshot() const { return snapshot_; }

  absl::StatusOr<std::shared_ptr<const OrientedCloud>> Load(const TaughtView& view) override {
    return taught_.Load(view);
  }
  absl::StatusOr<std::shared_ptr<const SurfaceModel>> LoadModel(
      const TaughtView& view, const TaughtStablePose& stable_pose) override {
    if (stable_pose.name != "objects/twin/stablePoses/upright") {
      return taught_.LoadModel(view, stable_pose);
    }
    const auto& poses = *taught_.snapshot().stable_poses;
    const TaughtStablePose& tower = *poses.at("objects/tower/stablePoses/upright");
    auto model = taught_.LoadModel(*tower.views.front(), tower);
    if (!twin_ && model.ok()) twin_ = std::make_shared<const SurfaceModel>(**model);
    return twin_;
  }

 private:
  TaughtShapes taught_;
  CatalogueSnapshot snapshot_;
  std::shared_ptr<const SurfaceModel> twin_;
};

Detection MustDetect(ViewClouds& clouds, const CatalogueSnapshot& catalogue, const char* part) {
  const auto found = Recognize(TaughtShapes::See({TaughtShapes::Part(part, 0.02, 0.01, 40)}),
                               catalogue, clouds, {}, [] { return false; });
  EXPECT_THAT(found, IsOk());
  return found.ok() && found->detections.size() == 1 ? found->detections[0] : Detection{};
}

TEST(Ambiguity, ObjectsOfOneShapeAreAmbiguous) {
  Twins twins;
  CatalogueSnapshot snapshot = twins.snapshot();
  std::vector<IndexedView> views;
  for (const auto& view : snapshot.stable_poses->at("objects/twin/stablePoses/upright")->views) {
    const auto cloud = twins.Load(
        *snapshot.stable_poses->at("objects/tower/stablePoses/upright")->views[views.size()]);
    ASSERT_THAT(cloud, IsOk());
    views.push_back({view, *Describe(**cloud, view->world_sensor, DescriptorParameters{}.kind)});
  }
  snapshot.index = snapshot.index.With(views);
  const Detection tower = MustDetect(twins, snapshot, "tower");
  EXPECT_EQ(tower.outcome, RecognitionOutcome::kAmbiguous);
  ASSERT_THAT(tower.alternatives, ::testing::Not(IsEmpty()));
  ASSERT_TRUE(tower.view);
  EXPECT_NE(tower.alternatives[0].view->object, tower.view->object);
  EXPECT_NEAR(tower.alternatives[0].score, tower.score, 0.05);
  EXPECT_THAT(tower.grasps, SizeIs(1));
  EXPECT_EQ(MustDetect(twins, snapshot, "bracket").outcome, RecognitionOutcome::kOk);
}

TEST(Ambiguity, AUniqueObjectIsNotAmbiguous) {
  TaughtShapes taught;
  const Detection tower = MustDetect(taught, taught.snapshot(), "tower");
  EXPECT_EQ(tower.outcome, RecognitionOutcome::kOk);
  EXPECT_THAT(tower.alternatives, IsEmpty());
}

}  // namespace
}  // namespace graspdb::recognition
