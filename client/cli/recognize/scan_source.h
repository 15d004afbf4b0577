// The inputs of `recognize`: point files and capture sets.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/cli/recognize/pose_error.h"
#include "graspdb/v1/capture_set.pb.h"
#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::client {

// One scan to recognise.
struct ScanTask {
  std::string path;                          // as it is printed
  std::filesystem::path file;                // to read
  v1::Capture capture;                       // no ground truth for a single file
  bool in_set = false;                       // whether `capture` came from a set
  const v1::CaptureSet* set = nullptr;       // its set
  std::shared_ptr<const ObjectModel> model;  // of the true object, where known
};

// All scans of the arguments; owns the sets that the tasks point into.
struct ScanTasks {
  std::vector<std::unique_ptr<v1::CaptureSet>> sets;
  std::vector<ScanTask> tasks;
};

// Expands the arguments: a folder is a capture set, of which `split` is used,
// any other argument a point file. Errors as LoadCaptureSet and LoadModels.
absl::StatusOr<ScanTasks> ListScans(const std::vector<std::string>& arguments,
                                    const std::string& split);

// Reads the scan of a task and makes the request, without cell and settings.
absl::StatusOr<v1::RecognizeRequest> ReadScan(const ScanTask& task);

}  // namespace graspdb::client
