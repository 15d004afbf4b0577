// A folder in the layout of BigBIRD as the paper's experiment (section 4).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lab/experiment/capture_trials.h"

namespace graspdb::client {

struct BigBirdOptions {
  // All of them are taught and asked. The paper has 24 + 96 views of an object, as many as one
  // camera took, and does not say which: NP3 is in the middle of the five.
  std::vector<std::string> cameras = {"NP3"};
  std::vector<std::string> objects = {};  // by folder; empty: all
  // Turns that are a multiple of this are taught, the others asked about.
  int teach_step_deg = 15;
};

// Whether `folder` is the folder of an object, or has some in it.
bool IsBigBird(const std::filesystem::path& folder);

// The objects in `folder`, or the one whose folder it is; see LoadBigBirdObject for what is read
// and for the frames. An object with a mesh has its origin below the middle of that. Points are
// read when they are needed, all but those of a view of each object with a mesh, which is checked
// against it.
//
// NOT_FOUND when there is no object, INVALID_ARGUMENT when a named object is not there;
// FAILED_PRECONDITION when nothing of an object is to be taught or nothing to be asked, a mesh is
// not where its object is, or, of a trial, a cloud is not over the turntable; errors as
// LoadBigBirdObject, LoadMesh, ReadPointFile and ReadDepthMap.
absl::StatusOr<CaptureTrials> LoadBigBirdTrials(const std::filesystem::path& folder,
                                                const BigBirdOptions& options);

}  // namespace graspdb::client
