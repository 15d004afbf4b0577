// What a catalogue may confuse, in words for the teacher.
#pragma once

#include <string>
#include <vector>

#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::client {

// A sentence each, with what to do: symmetries that are not declared as they were found, and pairs
// that look alike; with `nearly_too` what is only nearly so.
std::vector<std::string> LookAlikesText(const v1::FindLookAlikesResponse& found, bool nearly_too);

}  // namespace graspdb::client
