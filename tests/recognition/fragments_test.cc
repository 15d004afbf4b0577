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
    See(Strip(-0.1, -0.02, 0.03));
    Detection& bar = answers_.front().detection;
    bar.view = std::make_shared<const TaughtView>();
    bar.model = std::make_shared<const SurfaceModel>(Strip(-0.1, 0.1, 0), 1);
    bar.outcome = RecognitionOutcome::kOk;
    bar.refined_pose.translation() = Eigen::Vector3d(0, 0, 0.03);
  }

  // Another segment of the scene, without an answer.
  void See(OrientedCloud cloud) {
    const Segment segment = SegmentOf(std::move(cloud));
    answers_.push_back({segment, Unknown(segment)});
  }

  void Join() { JoinFragments(0.008, &answers_); }

  std::vector<AnsweredSegment> answers_;
};

TEST_F(FragmentsTest, ASegmentOnTheModelIsAPieceOfIt) {
  See(Strip(0.03, 0.1, 0.03));
  const std::size_t all =
      answers_[0].segment.cloud.points.size() + answers_[1].segment.cloud.points.size();
  Join();
  ASSERT_THAT(answers_, SizeIs(1));
  EXPECT_EQ(answers_[0].detection.outcome, RecognitionOutcome::kOk);
  EXPECT_EQ(answers_[0].detection.point_count, all);
  EXPECT_NEAR(answers_[0].detection.centroid.x(), 0, 0.01);
}

TEST_F(FragmentsTest, ASegmentElsewhereStaysUnknown) {
  See(Strip(0.03, 0.1, 0.05));   // above the bar
  See(Strip(0.08, 0.16, 0.03));  // mostly beyond its end
  Join();
  EXPECT_THAT(answers_, SizeIs(3));
}

TEST_F(FragmentsTest, WithoutAnAnswerNothingIsJoined) {
  See(Strip(0.03, 0.1, 0.03));
  answers_[0].detection.view = nullptr;
  Join();
  EXPECT_THAT(answers_, SizeIs(2));
}

// The left end has the better answer.
TEST_F(FragmentsTest, OneObjectIsFoundOnceInOnePlace) {
  See(Strip(0.03, 0.1, 0.03));
  answers_[1].detection = answers_[0].detection;
  answers_[1].detection.score = 0.8;
  answers_[0].detection.score = 0.9;
  Join();
  ASSERT_THAT(answers_, SizeIs(1));
  EXPECT_EQ(answers_[0].detection.score, 0.9);
}

TEST_F(FragmentsTest, TheSameObjectElsewhereStays) {
  See(Strip(0.13, 0.2, 0.03));
  answers_[1].detection = answers_[0].detection;
  answers_[1].detection.refined_pose.translation().x() = 0.22;
  Join();
  EXPECT_THAT(answers_, SizeIs(2));
}

TEST_F(FragmentsTest, AnotherObjectIsNoPiece) {
  See(Strip(0.03, 0.1, 0.03));
  TaughtView other;
  other.object = "objects/other";
  answers_[1].detection.view = std::make_shared<const TaughtView>(other);
  Join();
  EXPECT_THAT(answers_, SizeIs(2));
}

}  // namespace
}  // namespace graspdb::recognition
