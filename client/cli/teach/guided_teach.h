// `graspdb teach OBJECT --sensor SPEC`.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/cli/base/command.h"
#include "client/cli/teach/unattended_prompt.h"

namespace graspdb::client {

struct GuidedTeachOptions {
  std::string object;
  std::string display_name;
  std::string cell;          // id
  std::string sensor;        // see OpenSensor
  std::vector<double> axis;  // X, Y, m; or none
  double plate_height_m = 0;
  double step_deg = 20;
  bool clockwise = false;
  Unattended unattended;
};

// Guides the person at the terminal (on stderr with --json) and prints the result. NOT_FOUND, with
// advice, when there is no such cell; FAILED_PRECONDITION when an unattended run ended before
// everything was taught; errors of OpenSensor and GuidedTeaching.
absl::Status RunGuidedTeach(const GlobalOptions& global, const GuidedTeachOptions& options);

}  // namespace graspdb::client
