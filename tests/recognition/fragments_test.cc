#include "recognition/fragments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace graspdb::recognition {
namespace {

using ::testing::SizeIs;

// A strip along x, 2 mm between the points.
OrientedCloud Strip(double from_m, double to_m, double height_m) {
  OrientedCloud out;
  for (double x = from_m; x <= to_m; x += 0.002) {
    for (double y = -0.01; y <= 0.01; y += 0.002) {
      out.points.push_back(Eigen::Vector3d(x, y, height_m).cast<float>());
      out.normals.emplace_back(0.0F, 0.0F, 1.0F);
    }
  }
  return out;
}

Segment SegmentOf(OrientedCloud cloud) {
  Segment out;
  out.centroid = Centroid(cloud.points);
  out.cloud = std::move(cloud);
  return out;
}

Detection Unknown(const Segment& segment) {
  Detection out;
  out.centroid = segment.centroid;
  out.point_count = segment.cloud.points.size();
  return out;
}

// A bar of 20 cm whose middle is not seen: its left end has an answer.
class FragmentsTest : public ::testing::Test {
 protected:
  FragmentsTest() {
    Detection bar = Unknown(segments_[0]);
    bar.view = std::make_shared<const TaughtView>();
    bar.model = std::make_shared<const SurfaceModel>(Strip(-0.1, 0.1, 0), 1);
    bar.outcome = RecognitionOutcome::kOk;
    bar.refined_pose.translation() = Eigen::Vector3d(0, 0, 0.03);
    detections_.push_back(std::move(bar));
  }

  // Another segment of the scene, without an answer.
  void See(OrientedCloud cloud) {
    segments_.push_back(SegmentOf(std::move(cloud)));
    detections_.push_back(Unknown(segments_.back()));
  }

  std::vector<Segment> segments_ = {SegmentOf(Strip(-0.1, -0.02, 0.03))};
  std::vector<Detection> detections_;
};

TEST_F(FragmentsTest, WhatLiesOnTheModelIsAPieceOfIt) {
  See(Strip(0.03, 0.1, 0.03));
  const std::size_t all = segments_[0].cloud.points.size() + segments_[1].cloud.points.size();
  JoinFragments(segments_, 0.008, &detections_);
  ASSERT_THAT(detections_, SizeIs(1));
  EXPECT_EQ(detections_[0].outcome, RecognitionOutcome::kOk);
  EXPECT_EQ(detections_[0].point_count, all);
  EXPECT_NEAR(detections_[0].centroid.x(), 0, 0.01);
}

TEST_F(FragmentsTest, WhatStandsElsewhereStaysUnknown) {
  See(Strip(0.03, 0.1, 0.05));   // above the bar
  See(Strip(0.08, 0.16, 0.03));  // mostly beyond its end
  JoinFragments(segments_, 0.008, &detections_);
  EXPECT_THAT(detections_, SizeIs(3));
}

TEST_F(FragmentsTest, WithoutAnAnswerThereIsNothingToBeAPieceOf) {
  See(Strip(0.03, 0.1, 0.03));
  detections_[0].view = nullptr;
  JoinFragments(segments_, 0.008, &detections_);
  EXPECT_THAT(detections_, SizeIs(2));
}

TEST_F(FragmentsTest, AThingWithAnAnswerOfItsOwnIsNoPiece) {
  See(Strip(0.03, 0.1, 0.03));
  detections_[1].view = std::make_shared<const TaughtView>();
  JoinFragments(segments_, 0.008, &detections_);
  EXPECT_THAT(detections_, SizeIs(2));
}

}  // namespace
}  // namespace graspdb::recognition
