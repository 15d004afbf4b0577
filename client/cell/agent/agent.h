// All parts of a cell's agent put together.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "client/cell/agent/agent_options.h"
#include "client/cell/sensors/depth_sensor.h"

namespace graspdb::client {

// An agent that runs. Destroying it hangs up on robots and waits for the jobs that run.
class Agent {
 public:
  // Listens, with the camera given. Neither the camera nor the server need be there yet. Errors say
  // what to do next.
  static absl::StatusOr<std::unique_ptr<Agent>> Start(const AgentOptions& options,
                                                      std::unique_ptr<DepthSensor> sensor);
  ~Agent();
  Agent(const Agent&) = delete;
  Agent& operator=(const Agent&) = delete;

  // HOST:PORT with the ports that were picked; empty where it does not listen.
  std::string gri_address() const;
  std::string line_address() const;
  std::string health_address() const;

 private:
  struct Parts;
  explicit Agent(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace graspdb::client
