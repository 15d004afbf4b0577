// The experiment for programs.
#pragma once

#include <google/protobuf/struct.pb.h>

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lab/experiment/experiment.h"

namespace graspdb::client {

// {"name", "settings", "summary", "time", "objects", "answers"}; the unit is in each key: _mm,
// _deg, _ms, _m. Shares are 0 to 1. What was not measured is null, e.g. the pose error of an answer
// that names another object.
google::protobuf::Value CaseAsJson(const CaseResult& result);

// {"command", "cases"}, indented, keys in alphabetical order: the same cases give the same bytes.
// INTERNAL when the library refuses it.
absl::StatusOr<std::string> ReportJson(const std::string& command,
                                       const std::vector<google::protobuf::Value>& cases);

}  // namespace graspdb::client
