// The agent of a cell: camera, client and robot servers.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "client/cell/agent/settings/agent_options.h"
#include "client/cell/sensors/depth_sensor.h"

namespace graspdb::client {

// A running agent. Destruction closes the robots' connections and waits for running jobs.
class Agent {
 public:
  // Listens, with the given camera. Camera and server need not be available yet. Error messages
  // contain the next step.
  static absl::StatusOr<std::unique_ptr<Agent>> Start(const AgentOptions& options,
                                                      std::unique_ptr<DepthSensor> sensor);
  ~Agent();
  Agent(const Agent&) = delete;
  Agent& operator=(const Agent&) = delete;

  // HOST:PORT with the actual port; empty when not listening.
  std::string gri_address() const;
  std::string line_address() const;
  std::string health_address() const;
  std::string metrics_address() const;

 private:
  struct Parts;
  explicit Agent(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace graspdb::client
