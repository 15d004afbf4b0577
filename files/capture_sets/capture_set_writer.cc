#include "files/capture_sets/capture_set_writer.h"

#include "base/status_macros.h"
#include "files/base/atomic_file.h"
#include "files/capture_sets/capture_set.h"

namespace graspdb::files {

absl::Status CaptureSetWriter::AddCloud(const std::string& path, const PointFile& cloud) {
  const std::filesystem::path file = folder_ / path;
  if (const auto folder = file.parent_path(); !cloud_folders_.contains(folder)) {
    RETURN_IF_ERROR(MakeDurableFolder(folder));
    cloud_folders_.insert(folder);
  }
  return WritePcd(file, cloud, Durability::kBytes);
}

absl::Status CaptureSetWriter::Finish(const v1::CaptureSet& set) {
  // First, so that no description on the disk lacks its clouds.
  for (const std::filesystem::path& folder : cloud_folders_) {
    RETURN_IF_ERROR(FlushNames(folder));
  }
  return SaveCaptureSet(folder_, set);
}

}  // namespace graspdb::files
