// The captures of a set that a command processes.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "graspdb/v1/capture_set.pb.h"

namespace graspdb::client {

// Adds --split TEACH|QUERY|ALL.
void AddSplitFlag(CLI::App& command, std::string* split);

// The captures of the split ("ALL": all), in the order of the file.
std::vector<const v1::Capture*> CapturesOfSplit(const v1::CaptureSet& set,
                                                const std::string& split);

// The captures of the split that name an object and a stable pose.
std::vector<const v1::Capture*> TeachableCaptures(const v1::CaptureSet& set,
                                                  const std::string& split);

}  // namespace graspdb::client
