// A simulated turntable before a simulated camera, and a scripted person who turns it as prompted.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/teaching/turntable/turn_dialogue.h"
#include "client/teaching/turntable/turntable_coverage.h"
#include "rendering/capture_plan.h"
#include "rendering/meshes/solid.h"
#include "rendering/random/counter_random.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

constexpr double kPlateHeightM = 0.04;

// Of the turntable, world frame, m.
inline Eigen::Vector2d Axis() { return {0.05, -0.03}; }

// The part, a wall that occludes most of it, and the plate of a turntable.
inline std::vector<rendering::Workpiece> WithScenery(const rendering::Workpiece& part) {
  rendering::Workpiece wall = part;
  wall.object_id = "wall";
  wall.mesh = rendering::BoxSolid({-0.1F, 0, -0.05F}, {0.006F, 0.002F, 0.4F});
  rendering::Workpiece plate = part;
  plate.object_id = "plate";
  plate.mesh = rendering::CylinderSolid({0, 0}, 0.15F, 0, static_cast<float>(kPlateHeightM));
  return {part, std::move(wall), std::move(plate)};
}

// A turntable with a part that stands a little beside its axis.
struct Turntable {
  double turned_deg = 0;
  Eigen::Vector3d beside = {0.008, -0.005, 0};  // where the part stands on the plate, m
  bool has_plate = false;                       // of kPlateHeightM
  bool is_empty = false;
  bool is_hidden = false;  // all but a corner of it
  bool is_frozen = false;  // the camera
  std::uint64_t frame = 0;

  recognition::Pose World() const {
    return OnTurntable(Axis(), has_plate ? kPlateHeightM : 0, turned_deg) *
           recognition::Pose(Eigen::Translation3d(beside));
  }
  absl::StatusOr<rendering::PlannedCapture> Scene() {
    rendering::PlannedCapture scene;
    scene.world_sensor = rendering::LookAt({Axis().x(), Axis().y(), 0}, 0.7, 40, -90);
    scene.seed = rendering::RandomBits(7, 8, is_frozen ? 0 : frame++);
    if (!is_empty) scene.placements.push_back({.part = 0, .world_object = World()});
    if (has_plate) {
      scene.placements.push_back({.part = 2, .world_object = OnTurntable(Axis(), 0, 0)});
    }
    if (is_hidden) {
      recognition::Pose wall =
          recognition::Pose::Identity();  // between camera and part, out of the region
      wall.translation() = Eigen::Vector3d(Axis().x(), -0.36, 0.25);
      scene.placements.push_back({.part = 1, .world_object = wall});
    }
    return scene;
  }
};

// Answers the prompts in order and turns the table as requested; after the last answer the input
// ends.
class Person : public TeachingPrompt {
 public:
  explicit Person(Turntable& table) : table_(table) {}

  Person& Answers(const std::string& answer, int times = 1) {
    for (int i = 0; i < times; ++i) script_.push_back({.answer = answer, .first = {}});
    return *this;
  }
  // Runs `first`, then answers.
  Person& Does(std::function<void()> first, const std::string& answer = "") {
    script_.push_back({.answer = answer, .first = std::move(first)});
    return *this;
  }

  void Print(const std::string& text) override { printed_.push_back(text); }
  std::optional<std::string> ReadLine(const std::string& question) override {
    prompts_.push_back(question);
    if (next_ == script_.size()) return std::nullopt;
    const std::string order = "turn the object to ";
    if (question.starts_with(order)) table_.turned_deg = std::stod(question.substr(order.size()));
    const Step& step = script_[next_++];
    if (step.first) step.first();
    return step.answer;
  }

  const std::vector<std::string>& printed() const { return printed_; }
  const std::vector<std::string>& prompts() const { return prompts_; }
  bool IsDone() const { return next_ == script_.size(); }

 private:
  struct Step {
    std::string answer;
    std::function<void()> first;
  };
  Turntable& table_;
  std::vector<Step> script_;
  std::size_t next_ = 0;
  std::vector<std::string> printed_;
  std::vector<std::string> prompts_;
};

}  // namespace graspdb::client
