// Look-alikes in a catalogue as text for the teacher.
#pragma once

#include <string>
#include <vector>

#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::client {

// A sentence with advice for each symmetry that differs from the declared one and each pair that
// looks alike; with `nearly_too` also for those that are only nearly so.
std::vector<std::string> LookAlikesText(const v1::FindLookAlikesResponse& found, bool nearly_too);

}  // namespace graspdb::client
