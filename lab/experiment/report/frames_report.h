// The files of a report about frames of real cameras.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "lab/experiment/real_frames.h"

namespace graspdb::lab {

// How many true poses came as far as each stage, first the headings: of frames whose arrangement is
// "separated" in words, of the others, of all, and what segments and the search in the image
// alone did for all. What an accepted answer of a segment explains is not searched for.
std::vector<std::vector<std::string>> StageTable(const std::vector<FrameResult>& results);

// Writes into `folder`, which exists:
//   report.json                FramesJson
//   stages.md                  StageTable, for documents
//   graspdb_frames-test.csv    the accepted poses as the BOP challenge takes them
//   bop_objects.csv            the numbers of the objects in it
// Errors as FramesJson and WriteFileAtomically.
absl::Status WriteFramesReport(const std::filesystem::path& folder, const std::string& command,
                               const std::vector<std::string>& object_ids,
                               const std::vector<FrameResult>& results);

}  // namespace graspdb::lab
