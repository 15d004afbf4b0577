// The inputs of `recognize`: files of captures and capture sets.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graspdb/v1/capture_set.pb.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "rendering/pose_error.h"

namespace graspdb::client {

// One scan to recognise.
struct ScanTask {
  std::string path;                     // as it is printed
  std::filesystem::path file;           // to read
  v1::Capture capture;                  // no ground truth for a single file
  bool in_set = false;                  // whether `capture` came from a set
  const v1::CaptureSet* set = nullptr;  // its set
  std::shared_ptr<const rendering::MeasuredShape>
      shape;  // of the true object, if the set has its mesh
};

// All scans of the arguments; owns the sets that the tasks point into.
struct ScanTasks {
  std::vector<std::unique_ptr<v1::CaptureSet>> sets;
  std::vector<ScanTask> tasks;
};

// Expands the arguments: a folder is a capture set, of which `split` is used,
// any other argument a file (see scan_file.h). Errors as LoadCaptureSet and LoadMeshInMetres.
absl::StatusOr<ScanTasks> ListScans(const std::vector<std::string>& arguments,
                                    const std::string& split);

// Reads the scan of a task and makes the request, without cell and settings.
absl::StatusOr<v1::RecognizeRequest> ReadScan(const ScanTask& task);

}  // namespace graspdb::client
