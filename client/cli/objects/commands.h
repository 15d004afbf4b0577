// `graspdb objects`, `status`, `doctor`, `watch`, `import`, `uploads` and `export`.
#pragma once

#include <string>

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `objects list|show|check|thresholds|delete`.
void AddObjectsCommand(CLI::App& app, const GlobalOptions& global, Action* action);
// Adds `thresholds` under `objects`.
void AddThresholdsCommand(CLI::App& objects, const GlobalOptions& global, Action* action);
// One line per stable pose: the scores of its views and the resulting threshold.
std::string ThresholdText(const v1::ThresholdProposal& proposal);

void AddStatusCommand(CLI::App& app, const GlobalOptions& global, Action* action);
void AddDoctorCommand(CLI::App& app, const GlobalOptions& global, Action* action);
// Prints the changes of the catalogue.
void AddWatchCommand(CLI::App& app, const GlobalOptions& global, Action* action);

// Adds `import SET [--split TEACH]`.
void AddImportCommand(CLI::App& app, const GlobalOptions& global, Action* action);
// Adds `uploads list|show|commit|delete`: bulk uploads that were interrupted or are in progress.
void AddUploadsCommand(CLI::App& app, const GlobalOptions& global, Action* action);

// Adds `export SET`.
void AddExportCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
