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

// {"name", "description", "settings", "summary", "time", "parts", "objects", "answers", "drawings",
// "first_matches"}; of captures of a set, "settings" are the numbers of parts only. "part_answered"
// of an answer is the place in "parts", from 1, of the part in whose frame "camera_object" is. The
// unit is in each key: _mm, _deg, _ms, _m. Shares are 0 to 1. Null: not measured, e.g. the pose
// error of an answer that names another object, or that has no true pose ("posed").
google::protobuf::Value CaseAsJson(const CaseResult& result);

// {"command", "descriptors", "cases"}, indented, keys in alphabetical order: the same cases give
// the same bytes. INTERNAL when the library refuses it.
absl::StatusOr<std::string> ReportJson(const std::string& command,
                                       const std::vector<DescriptorFigures>& descriptors,
                                       const std::vector<google::protobuf::Value>& cases);

// How many true poses came as far as each stage, first the headings: of frames whose arrangement is
// "separated" in words, of the others, of all, and what segments and the search in the image
// alone did for all. What an accepted answer of a segment explains is not searched for.
std::vector<std::vector<std::string>> StageTable(const std::vector<FrameResult>& results);

// What was found in frames of real cameras: {"command", "objects", "stages", "frames": [{"name",
// "sensor", "arrangement", "error", "ms", "objects", "detections"}]}, laid out as ReportJson;
// "stages" is StageTable(). INTERNAL when the library refuses it.
absl::StatusOr<std::string> FramesJson(const std::string& command,
                                       const std::vector<std::string>& object_ids,
                                       const std::vector<FrameResult>& results);

}  // namespace graspdb::lab
