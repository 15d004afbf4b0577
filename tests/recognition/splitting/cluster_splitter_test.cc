// Objects that the camera sees as one cluster.
#include "recognition/splitting/cluster_splitter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/recognition/taught_shapes.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::LargestCornerError;
using ::graspdb::testing::Solid;
using ::graspdb::testing::TaughtShapes;
using ::testing::SizeIs;

class TouchingTest : public ::testing::Test {
 protected:
  std::vector<Detection> See(const std::vector<Solid>& parts) {
    const auto found =
        Recognize(TaughtShapes::See(parts), taught_.snapshot(), taught_, {}, [] { return false; });
    EXPECT_THAT(found, IsOk());
    return found.ok() ? found->detections : std::vector<Detection>();
  }

  // The detection of an object; null where it is not named.
  static const Detection* Of(const std::string& object, const std::vector<Detection>& found) {
    for (const Detection& d : found) {
      if (d.view && d.view->object == "objects/" + object) return &d;
    }
    return nullptr;
  }

  static void ExpectTouchingAt(const Solid& part, const std::string& object,
                               const std::vector<Detection>& found) {
    const Detection* detection = Of(object, found);
    ASSERT_NE(detection, nullptr) << object;
    EXPECT_TRUE(detection->touching) << object;
    EXPECT_LT(LargestCornerError(object, detection->refined_pose, part.world_solid), 0.005)
        << object;
  }

  // An object that was never taught, as large as the others.
  static Solid UnknownSolid(double x, double y) {
    Solid out;
    out.world_solid.translation() = Eigen::Vector3d(x, y, 0);
    out.boxes = {{{-0.03, -0.03, 0}, {0.03, 0.03, 0.07}}, {{-0.05, -0.01, 0}, {0.05, 0.01, 0.10}}};
    return out;
  }

  TaughtShapes taught_;
};

// 7 mm apart, less than the cluster tolerance.
TEST_F(TouchingTest, TwoKnownObjectsAreBothNamedWhereTheyStand) {
  const Solid bracket = TaughtShapes::Part("bracket", -0.05, 0, 0);
  const Solid tower = TaughtShapes::Part("tower", 0.027, 0.01, 0);
  const auto found = See({bracket, tower});
  ASSERT_THAT(found, SizeIs(2));
  ExpectTouchingAt(bracket, "bracket", found);
  ExpectTouchingAt(tower, "tower", found);
  const Eigen::Vector3d sensor = TaughtShapes::WorldSensor().translation();
  EXPECT_LE((found[0].centroid - sensor).norm(), (found[1].centroid - sensor).norm());
}

TEST_F(TouchingTest, AScanOfOneObjectAloneIsNotSplit) {
  const Scan frame = TaughtShapes::See(
      {TaughtShapes::Part("bracket", -0.05, 0, 0), TaughtShapes::Part("tower", 0.027, 0.01, 0)});
  StageLog log;
  const auto seen = SegmentScan(
      frame, {}, {}, [] { return false; }, &log);
  ASSERT_THAT(seen, IsOk());
  ASSERT_THAT(seen->segments, SizeIs(1));
  Scan alone = frame;
  alone.points = Transform(seen->world_sensor.inverse(), seen->segments[0].cloud.points);
  alone.segmented = true;
  const auto found = Recognize(alone, taught_.snapshot(), taught_, {}, [] { return false; });
  ASSERT_THAT(found, IsOk());
  ASSERT_THAT(found->detections, SizeIs(1));
  EXPECT_FALSE(found->detections[0].touching);
}

TEST_F(TouchingTest, AKnownObjectThatTouchesAnUnknownOneIsMarked) {
  const Solid slab = TaughtShapes::Part("slab", -0.061, 0, 0);
  const Scan scan = TaughtShapes::See({slab, UnknownSolid(0.05, 0.02)});
  StageLog log;
  const auto seen = SegmentScan(
      scan, {}, {}, [] { return false; }, &log);
  ASSERT_THAT(seen, IsOk());
  ASSERT_THAT(seen->segments, SizeIs(1));
  const auto& pose = *taught_.snapshot().stable_poses->at("objects/slab/stablePoses/upright");
  Detection answer;
  answer.view = pose.views.front();
  answer.model = taught_.LoadModel(*answer.view, pose).value();
  answer.refined_pose = slab.world_solid;
  answer.score = 0.8;
  int calls = 0;
  const RecognizeAlone recognize_nothing = [&](const Segment&) {
    ++calls;
    return Detection();
  };
  const auto objects = PartTouching({scan, *seen, seen->segments[0]}, answer, SplittingOptions(),
                                    recognize_nothing, recognize_nothing, [] { return false; });
  ASSERT_THAT(objects, IsOk());
  ASSERT_THAT(*objects, SizeIs(1));
  EXPECT_EQ(objects->front().detection.view, answer.view);
  EXPECT_TRUE(objects->front().detection.touching);
  EXPECT_GT(calls, 0);
}

TEST_F(TouchingTest, CancellationWhileSplittingGivesNoAnswer) {
  const Scan scan = TaughtShapes::See({UnknownSolid(0.05, 0.02)});
  StageLog log;
  const auto seen = SegmentScan(
      scan, {}, {}, [] { return false; }, &log);
  ASSERT_THAT(seen, IsOk());
  const RecognizeAlone recognize_nothing = [](const Segment&) { return Detection(); };
  const auto objects =
      PartTouching({scan, *seen, seen->segments[0]}, Detection(), SplittingOptions(),
                   recognize_nothing, recognize_nothing, [] { return true; });
  EXPECT_EQ(objects.status().code(), absl::StatusCode::kCancelled);
}

// Two blocks of 300,000 voxels, 1 cm apart.
TEST_F(TouchingTest, RecognitionsOfHugeClustersAreLimited) {
  Scan scan;
  Segmentation seen;
  Segment whole;
  for (int i = 0; i < 600'000; ++i) {
    const int x = i % 100 + (i < 300'000 ? 0 : 103);
    whole.cloud.points.emplace_back(0.003F * static_cast<float>(x),
                                    0.003F * static_cast<float>(i / 100 % 100),
                                    0.003F * static_cast<float>(i / 10'000 % 30));
    whole.cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
  }
  int calls = 0;
  const RecognizeAlone recognize_nothing = [&](const Segment&) {
    ++calls;
    return Detection();
  };
  const auto objects = PartTouching({scan, seen, whole}, Detection(), SplittingOptions(),
                                    recognize_nothing, recognize_nothing, [] { return false; });
  ASSERT_THAT(objects, IsOk());
  EXPECT_EQ(calls, 2);  // the blocks, and not the halves as well
}

// A row of 27 blocks, 1 cm apart: more than are recognised. The first one is known.
TEST_F(TouchingTest, PartsBeyondTheLimitHaveTheirPlaceAndSize) {
  Scan scan;
  Segmentation seen;
  Segment whole;
  for (int i = 0; i < 27 * 216; ++i) {
    const int x = i / 216 * 10 + i % 6;
    whole.cloud.points.emplace_back(0.003F * static_cast<float>(x),
                                    0.003F * static_cast<float>(i / 6 % 6),
                                    0.003F * static_cast<float>(i / 36 % 6));
    whole.cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
  }
  int calls = 0;
  const RecognizeAlone recognize_first = [&](const Segment& segment) {
    Detection out;
    out.point_count = segment.cloud.points.size();
    out.centroid = segment.centroid;
    if (calls++ > 0) return out;
    out.view = std::make_shared<const TaughtView>();
    out.model = std::make_shared<const SurfaceModel>(segment.cloud, 1);
    out.score = out.evidence.scan_explained = 1;
    return out;
  };
  const auto objects = PartTouching({scan, seen, whole}, Detection(), SplittingOptions(),
                                    recognize_first, recognize_first, [] { return false; });
  ASSERT_THAT(objects, IsOk());
  ASSERT_THAT(*objects, SizeIs(27));
  EXPECT_LT(calls, 27);
  for (const AnsweredSegment& object : *objects) {
    EXPECT_EQ(object.detection.point_count, 216U);
    EXPECT_EQ(object.detection.centroid, object.segment.centroid);
  }
}

TEST_F(TouchingTest, AnUnknownObjectIsNotSplit) {
  const auto found = See({UnknownSolid(0, 0), UnknownSolid(0.1, 0.02)});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_FALSE(found[0].view);
}

TEST_F(TouchingTest, SeparateObjectsDoNotTouch) {
  const auto found =
      See({TaughtShapes::Part("bracket", -0.08, 0, 40), TaughtShapes::Part("tower", 0.08, 0, 70)});
  ASSERT_THAT(found, SizeIs(2));
  for (const Detection& d : found) {
    EXPECT_TRUE(d.view);
    EXPECT_FALSE(d.touching);
  }
}

}  // namespace
}  // namespace graspdb::recognition
