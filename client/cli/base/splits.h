// Which captures of a set a command works on.
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

// Those of them that say which object in which stable pose they show.
std::vector<const v1::Capture*> TeachableCaptures(const v1::CaptureSet& set,
                                                  const std::string& split);

}  // namespace graspdb::client
