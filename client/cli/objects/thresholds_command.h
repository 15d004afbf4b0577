// `graspdb objects thresholds`.
#pragma once

#include <string>

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds it under `objects`.
void AddThresholdsCommand(CLI::App& objects, const GlobalOptions& global, Action* action);

// One line per stable pose: the scores of its views and the resulting threshold.
std::string ThresholdText(const v1::ThresholdProposal& proposal);

}  // namespace graspdb::client
