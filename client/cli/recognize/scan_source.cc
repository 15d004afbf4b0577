#include "client/cli/recognize/scan_source.h"

#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cli/base/splits.h"
#include "files/capture_sets/capture_set.h"
#include "files/messages/pose_message.h"
#include "files/scan_file.h"
#include "rendering/mesh_part.h"

namespace graspdb::client {
namespace {

using Shapes = std::map<std::string, std::shared_ptr<const rendering::MeasuredShape>>;

// Of the set's objects that have a mesh, by object id.
absl::StatusOr<Shapes> LoadShapes(const std::filesystem::path& folder, const v1::CaptureSet& set) {
  Shapes out;
  for (const v1::CapturedObject& object : set.objects()) {
    if (object.mesh_path().empty()) continue;
    ASSIGN_OR_RETURN(rendering::TriangleMesh mesh,
                     rendering::LoadMeshInMetres(folder / object.mesh_path()));
    out[object.object_id()] =
        std::make_shared<const rendering::MeasuredShape>(rendering::Measure(mesh));
  }
  return out;
}

absl::Status AddSet(const std::string& folder, const std::string& split, ScanTasks* out) {
  ASSIGN_OR_RETURN(v1::CaptureSet loaded, files::LoadCaptureSet(folder));
  out->sets.push_back(std::make_unique<v1::CaptureSet>(std::move(loaded)));
  const v1::CaptureSet& set = *out->sets.back();
  ASSIGN_OR_RETURN(const Shapes shapes, LoadShapes(folder, set));
  const std::vector<const v1::Capture*> captures = CapturesOfSplit(set, split);
  if (captures.empty()) {
    return absl::FailedPreconditionError(
        absl::StrCat(folder, " has no captures in split ", split, "; choose another --split"));
  }
  for (const v1::Capture* capture : captures) {
    ScanTask task;
    task.path = capture->path();
    task.file = std::filesystem::path(folder) / capture->path();
    task.capture = *capture;
    task.in_set = true;
    task.set = &set;
    const auto shape = shapes.find(capture->object_id());
    if (shape != shapes.end()) task.shape = shape->second;
    out->tasks.push_back(std::move(task));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<ScanTasks> ListScans(const std::vector<std::string>& arguments,
                                    const std::string& split) {
  ScanTasks out;
  for (const std::string& argument : arguments) {
    std::error_code ignored;  // other paths are read as files, which reports the error
    if (std::filesystem::is_directory(argument, ignored)) {
      RETURN_IF_ERROR(AddSet(argument, split, &out));
    } else {
      ScanTask task;
      task.path = argument;
      task.file = argument;
      out.tasks.push_back(std::move(task));
    }
  }
  return out;
}

absl::StatusOr<v1::RecognizeRequest> ReadScan(const ScanTask& task) {
  ASSIGN_OR_RETURN(files::ScanFile file, files::ReadScanFile(task.file));
  v1::RecognizeRequest request;
  files::SetScan(std::move(file.scan), &request);
  request.set_segmented(task.capture.segmented());
  if (task.capture.has_sensor_pose()) {
    *request.mutable_sensor_pose() = task.capture.sensor_pose();
  } else if (file.sensor_pose) {
    *request.mutable_sensor_pose() = files::ToMessage(*file.sensor_pose);
  }
  if (task.set != nullptr && task.set->has_region_of_interest()) {
    *request.mutable_region_of_interest() = task.set->region_of_interest();
  }
  return request;
}

}  // namespace graspdb::client
