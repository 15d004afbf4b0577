// A small catalogue of parts made of boxes, taught from all sides.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "recognition/models/clouds_in_memory.h"
#include "recognition/recognizer.h"
#include "tests/recognition/scenes/table_scene.h"

namespace graspdb::testing {

// "bracket" (two grasps), "tower" (one grasp) and "slab" (none), without symmetry. Each
// has one stable pose and 18 views, 20 degrees apart.
class TaughtShapes : public recognition::CloudsInMemory {
 public:
  // `shares_frame`: all views of a part make one model; else each is a model of its own.
  explicit TaughtShapes(bool shares_frame = true);

  // The part at (x, y), turned by `yaw_deg`.
  static Solid Part(const std::string& object, double x, double y, double yaw_deg);

  // The sensor of all taught views.
  static recognition::Pose WorldSensor();

  // The sensor's scan of these parts on the table.
  static recognition::Scan See(const std::vector<Solid>& parts);
  // An image with 1.25 mm a pixel at 0.6 m, about as many as depth cameras have.
  static recognition::Scan SeeFinely(const std::vector<Solid>& parts);

  const recognition::CatalogueSnapshot& snapshot() const { return snapshot_; }

 private:
  void Teach(const std::string& object, std::vector<recognition::TaughtGrasp> grasps);

  const bool shares_frame_;
  std::unordered_map<std::string, std::shared_ptr<const recognition::TaughtStablePose>>
      stable_poses_;
  std::vector<recognition::IndexedView> views_;
  recognition::CatalogueSnapshot snapshot_;
};

// The largest distance between the corners of the part in two poses.
double LargestCornerError(const std::string& object, const recognition::Pose& a,
                          const recognition::Pose& b);

}  // namespace graspdb::testing
