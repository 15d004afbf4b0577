// Objects that the camera sees as one cluster.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recognition/recognizer.h"
#include "recognition/segmentation/segmentation.h"
#include "tests/recognition/scenes/taught_shapes.h"
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
    const auto found = Recognize(TaughtShapes::SeeFinely(parts), taught_.snapshot(), taught_, {},
                                 [] { return false; });
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
  const auto found = See({slab, UnknownSolid(0.05, 0.02)});
  ExpectTouchingAt(slab, "slab", found);
  EXPECT_EQ(Of("bracket", found), nullptr);
  EXPECT_EQ(Of("tower", found), nullptr);
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
