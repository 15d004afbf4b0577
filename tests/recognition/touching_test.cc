// Things that the camera sees as one.
#include "recognition/touching.h"

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

  // Something that was never taught, as large as the others.
  static Solid Stranger(double x, double y) {
    Solid out;
    out.world_solid.translation() = Eigen::Vector3d(x, y, 0);
    out.boxes = {{{-0.03, -0.03, 0}, {0.03, 0.03, 0.07}}, {{-0.05, -0.01, 0}, {0.05, 0.01, 0.10}}};
    return out;
  }

  TaughtShapes taught_;
};

TEST_F(TouchingTest, TwoKnownThingsAreBothNamedWhereTheyStand) {
  const Solid bracket = TaughtShapes::Part("bracket", -0.046, 0, 0);
  const Solid tower = TaughtShapes::Part("tower", 0.026, 0.01, 0);
  const auto found = See({bracket, tower});
  ASSERT_THAT(found, SizeIs(2));
  ExpectTouchingAt(bracket, "bracket", found);
  ExpectTouchingAt(tower, "tower", found);
}

TEST_F(TouchingTest, AKnownThingThatTouchesAStrangerSaysSoAndTheStrangerIsNotNamed) {
  const Solid slab = TaughtShapes::Part("slab", -0.061, 0, 0);
  const auto found = See({slab, Stranger(0.05, 0.02)});
  for (const Detection& d : found) {
    if (!d.view) continue;
    EXPECT_EQ(d.view->object, "objects/slab");
    EXPECT_TRUE(d.touching);
  }
}

TEST_F(TouchingTest, AStrangerIsNotTakenForThingsThatTouch) {
  for (const Detection& d : See({Stranger(0, 0), Stranger(0.1, 0.02)})) EXPECT_FALSE(d.view);
}

TEST_F(TouchingTest, ThingsThatStandAloneDoNotTouch) {
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
