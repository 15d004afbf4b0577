#include "recognition/verification/verification.h"

#include <gtest/gtest.h>

#include "recognition/verification/visibility.h"
#include "tests/recognition/scenes/table_scene.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::LookAt;
using ::graspdb::testing::SmallCamera;
using ::graspdb::testing::TakePicture;

constexpr double kToleranceM = 0.006;

// A box of 8 x 6 x 5 cm.
Box BrickBox() { return {{-0.04, -0.03, 0}, {0.04, 0.03, 0.05}}; }

OrientedCloud SurfaceOf(const Box& box) {
  OrientedCloud out;
  const Eigen::Vector3d size = box.max - box.min;
  constexpr double kStep = 0.0025;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    for (double a = kStep / 2; a < size[u]; a += kStep) {
      for (double b = kStep / 2; b < size[v]; b += kStep) {
        for (const double side : {0.0, 1.0}) {
          Eigen::Vector3d p = box.min;
          p[axis] += side * size[axis];
          p[u] += a;
          p[v] += b;
          out.points.push_back(p.cast<float>());
          Eigen::Vector3f normal = Eigen::Vector3f::Zero();
          normal[axis] = side > 0 ? 1.0F : -1.0F;
          out.normals.push_back(normal);
        }
      }
    }
  }
  return out;
}

class VerificationTest : public ::testing::Test {
 protected:
  // The evidence for `model` at `claimed` when the camera sees `solids`, the first alone in the
  // region of interest.
  Evidence MustVerify(const SurfaceModel& model, const Pose& claimed,
                      const std::vector<testing::Solid>& solids, bool segmented = false,
                      double min_score = 0) {
    const Pose world_sensor = LookAt({0, -0.5, 0.4}, {0, 0, 0.02});
    Scan scan{.points = TakePicture({.solids = solids}, world_sensor, SmallCamera()).points,
              .world_sensor = world_sensor,
              .region = Box{{-0.12, -0.12, -0.02}, {0.12, 0.12, 0.08}},
              .segmented = segmented};
    if (segmented) {
      std::erase_if(scan.points, [&](const Eigen::Vector3f& p) {
        return !p.allFinite() || (world_sensor * p.cast<double>()).z() < 0.003;
      });
    }
    StageLog log;
    const auto segmentation = SegmentScan(
        scan, {}, {}, [] { return false; }, &log);
    EXPECT_THAT(segmentation, IsOk());
    if (!segmentation.ok() || segmentation->segments.empty()) {
      ADD_FAILURE() << "no segment";
      return {};
    }
    const Segment& segment = segmentation->segments.front();
    return Verify(model, claimed, SoaCloud(segment.cloud), DepthBuffer(scan, world_sensor, segment),
                  {.tolerance_m = kToleranceM, .min_score = min_score});
  }

  static Pose At(double x, double y, double yaw_rad) {
    Pose pose = Pose::Identity();
    pose.translation() = Eigen::Vector3d(x, y, 0);
    pose.rotate(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
    return pose;
  }

  static testing::Solid BoxAt(const Pose& pose, const Box& box = BrickBox()) {
    return {pose, {box}};
  }

  const SurfaceModel model_{SurfaceOf(BrickBox()), 1};
  const Pose truth_ = At(0.02, 0.01, 0.5);
};

TEST_F(VerificationTest, TheTruePoseIsExplainedInBothDirections) {
  const Evidence evidence = MustVerify(model_, truth_, {BoxAt(truth_)});
  EXPECT_GT(evidence.scan_explained, 0.9);
  EXPECT_GT(evidence.model_seen, 0.9);
  EXPECT_GT(evidence.unoccluded, 0.9);
  EXPECT_GT(evidence.confirmed, 0.9);
  EXPECT_LT(evidence.contradicted + evidence.unmeasured, 0.1);
  EXPECT_GT(evidence.score, 0.9);
  EXPECT_LT(evidence.rms_m, 0.0015);
  EXPECT_GT(evidence.point_count, 100U);
}

TEST_F(VerificationTest, ATooLargeModelIsContradicted) {
  const Box larger{{-0.04, -0.03, 0}, {0.07, 0.03, 0.05}};
  const Evidence evidence = MustVerify(SurfaceModel(SurfaceOf(larger), 1), truth_, {BoxAt(truth_)});
  EXPECT_GT(evidence.scan_explained, 0.8);
  EXPECT_LT(evidence.model_seen, 0.86);
  EXPECT_GT(evidence.contradicted, 0.1);
  EXPECT_LT(evidence.unmeasured, evidence.contradicted);
}

TEST_F(VerificationTest, ATooSmallModelLeavesTheScanUnexplained) {
  const Box smaller{{-0.04, -0.03, 0}, {0.015, 0.03, 0.05}};
  const Evidence evidence =
      MustVerify(SurfaceModel(SurfaceOf(smaller), 1), truth_, {BoxAt(truth_)});
  EXPECT_LT(evidence.scan_explained, 0.85);
}

// Of the brick cut out of the scan a half is lost.
TEST_F(VerificationTest, AScoreThatTheSegmentsPointsExcludeIsNotComputed) {
  const SurfaceModel smaller(SurfaceOf({{-0.04, -0.03, 0}, {0.015, 0.03, 0.05}}), 1);
  const Evidence all = MustVerify(smaller, truth_, {BoxAt(truth_)});
  const double bound = 2 * all.scan_explained / (1 + all.scan_explained);
  ASSERT_LE(all.score, bound);
  const auto score = [&](double min_score) {
    return MustVerify(smaller, truth_, {BoxAt(truth_)}, false, min_score).score;
  };
  EXPECT_EQ(score(bound - 1e-9), all.score);
  EXPECT_EQ(score(bound + 1e-9), 0);
}

TEST_F(VerificationTest, MissingPointsInASegmentedScanCountLessThanFreeSpace) {
  const Box half{{-0.04, -0.03, 0}, {0, 0.03, 0.05}};
  const Evidence cut_out = MustVerify(model_, truth_, {BoxAt(truth_, half)}, /*segmented=*/true);
  const Evidence whole = MustVerify(model_, truth_, {BoxAt(truth_, half)});
  EXPECT_LT(whole.model_seen, 0.75);
  EXPECT_GT(cut_out.model_seen, whole.model_seen + 0.05);
  EXPECT_LT(cut_out.model_seen, 0.9);
  EXPECT_GT(cut_out.unmeasured, 0.3);
  EXPECT_LT(cut_out.contradicted, 0.05);
  EXPECT_GT(whole.contradicted, 0.2);
}

TEST_F(VerificationTest, OccludedSurfaceDoesNotCountAgainstThePose) {
  // A post near the camera, out of the region of interest.
  const Box post{{-0.02, -0.01, 0}, {0.02, 0.01, 0.3}};
  const Evidence evidence =
      MustVerify(model_, truth_, {BoxAt(truth_), BoxAt(At(0.02, -0.2, 0), post)});
  EXPECT_LT(evidence.unoccluded, 0.9);
  EXPECT_GT(evidence.unoccluded, 0.2);
  EXPECT_GT(evidence.model_seen, 0.85);
  EXPECT_GT(evidence.score, 0.85);
  EXPECT_LT(evidence.confirmed, 0.9);
  EXPECT_LT(evidence.contradicted, 0.05);
}

TEST_F(VerificationTest, TheWrongTurnScoresLess) {
  const double right = MustVerify(model_, truth_, {BoxAt(truth_)}).score;
  for (const double off : {0.2, 0.6, 1.57}) {
    const double wrong = MustVerify(model_, At(0.02, 0.01, 0.5 + off), {BoxAt(truth_)}).score;
    EXPECT_LT(wrong, right - 0.05) << off;
  }
}

TEST(VisibleSurface, IsTheSideTowardsTheCamera) {
  const SurfaceModel model(SurfaceOf(BrickBox()), 1);
  const Pose world_sensor = LookAt({0, -0.5, 0.4}, {0, 0, 0.02});
  const VisibleSurface seen(model.fine, world_sensor.inverse().cast<float>());
  const std::vector<std::size_t>& visible = seen.points();
  std::size_t expected = 0;
  for (std::size_t i = 0; i < model.fine.cloud.points.size(); ++i) {
    const Eigen::Vector3f& n = model.fine.cloud.normals[i];
    expected += n.z() > 0.5F || n.y() < -0.5F;
  }
  EXPECT_NEAR(static_cast<double>(visible.size()), static_cast<double>(expected),
              0.02 * static_cast<double>(expected));
  for (const std::size_t i : visible) {
    const Eigen::Vector3f& n = model.fine.cloud.normals[i];
    EXPECT_TRUE(n.z() > 0.5F || n.y() < -0.5F);
  }
}

}  // namespace
}  // namespace graspdb::recognition
