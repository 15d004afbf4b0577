// `graspdb objects`, `status`, `doctor`, `watch`, `import`, `uploads` and `export`.
#pragma once

#include <google/protobuf/timestamp.pb.h>

#include <string>

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `objects list|show|set|check|thresholds|delete` and those of AddHistoryCommands().
void AddObjectsCommand(CLI::App& app, const GlobalOptions& global, Action* action);
// Adds `undelete`, `purge`, `history`, `restore`, `release` and `draft` under `objects`.
void AddHistoryCommands(CLI::App& objects, const GlobalOptions& global, Action* action);
// What changed in an object, when and by whom: a line for the change, and one for each resource.
std::string RevisionText(const v1::ObjectRevision& revision);
// As 2026-11-26 15:26:16 +01:00 in the machine's time zone; logs are in UTC.
std::string LocalTimeText(const google::protobuf::Timestamp& time);
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
