// A cell as processes: a server that was taught parts, an agent with a simulated camera, a robot.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "client/cell/robots/gri/gri_client.h"
#include "rendering/capture_plan.h"
#include "rendering/workpiece.h"
#include "tests/end_to_end/programs_fixture.h"

namespace graspdb::end_to_end {

class CellProgramsTest : public ProgramsTest {
 protected:
  // A server with the parts of Simulate, and the cell "press-3" with a rotated robot beside the
  // table.
  void StartCell();
  // An agent of it; more flags may follow. Its camera reads the folder `scene_`.
  void StartAgent(const std::vector<std::string>& flags = {});
  // `environment` as NAME=VALUE.
  void StartAgentWith(const std::string& sensor, const std::vector<std::string>& flags = {},
                      const std::vector<std::string>& environment = {});
  const rendering::PlannedCapture& SceneNo(std::size_t scene) const { return scenes_.at(scene); }
  // Places the parts of a random scene before the camera.
  const rendering::PlannedCapture& LayOut(std::size_t scene);

  client::GriClient Robot() const;
  static client::GriRequest Request(client::GriAction action, int job = 1);
  client::GriResponse Trigger(client::GriClient& robot, int job = 1) const;
  // Polls until the agent returns the code; fails after half a minute.
  void AwaitCode(client::GriCode code, int job = 1) const;
  // Expects a grasp that holds in the scene of LayOut.
  void ExpectHolds(const client::GriResponse& answer) const;
  void ExpectHolds(const client::GriResponse& answer, const rendering::PlannedCapture& scene) const;
  bool Holds(const client::GriResponse& answer, const rendering::PlannedCapture& scene) const;

  static recognition::Pose WorldBase();

  std::string scene_ = "table";
  std::vector<rendering::Workpiece> parts_;
  std::unique_ptr<Process> agent_;
  std::string gri_;

 private:
  std::vector<rendering::PlannedCapture> scenes_;
  rendering::PlannedCapture shown_;
};

}  // namespace graspdb::end_to_end
