// The experiment for programs.
#pragma once

#include <google/protobuf/struct.pb.h>

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lab/experiment/descriptor_comparison.h"
#include "lab/experiment/experiment.h"
#include "lab/experiment/real_frames.h"

namespace graspdb::lab {

// {"name", "description", "settings", "summary", "time", "objects", "answers", "drawings",
// "first_matches"}; of captures of a set, "settings" are the numbers of parts only. The unit is in
// each key: _mm, _deg, _ms, _m. Shares are 0 to 1. Null: not measured, e.g. the pose error of an
// answer that names another object, or that has no true pose ("posed").
google::protobuf::Value CaseAsJson(const CaseResult& result);

// {"command", "descriptors", "cases"}, indented, keys in alphabetical order: the same cases give
// the same bytes. INTERNAL when the library refuses it.
absl::StatusOr<std::string> ReportJson(const std::string& command,
                                       const std::vector<DescriptorFigures>& descriptors,
                                       const std::vector<google::protobuf::Value>& cases);

// What was found in frames of real cameras: {"command", "frames": [{"name", "sensor",
// "arrangement", "error", "ms", "objects", "detections"}]}, laid out as ReportJson. INTERNAL when
// the library refuses it.
absl::StatusOr<std::string> FramesJson(const std::string& command,
                                       const std::vector<FrameResult>& results);

}  // namespace graspdb::lab
