#include "files/scan_file.h"

#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "files/cloud_message.h"
#include "files/depth_png.h"
#include "files/point_file.h"

namespace graspdb::client {
namespace {

std::string ExtensionOf(const std::filesystem::path& path) {
  return absl::AsciiStrToLower(path.extension().string());
}

}  // namespace

bool IsScanFile(const std::filesystem::path& path) {
  const std::string extension = ExtensionOf(path);
  return extension == ".pcd" || extension == ".ply" || extension == ".png";
}

absl::StatusOr<ScanFile> ReadScanFile(const std::filesystem::path& path) {
  if (ExtensionOf(path) != ".png") {
    const absl::StatusOr<PointFile> file = ReadPointFile(path);
    if (!file.ok()) return file.status();
    return ScanFile{.scan = CloudMessage(*file), .sensor_pose = file->sensor_pose};
  }
  const absl::StatusOr<DepthPngCamera> camera =
      ReadIntrinsics(path.parent_path() / kIntrinsicsFile);
  if (!camera.ok()) return camera.status();
  absl::StatusOr<v1::DepthImage> image = ReadDepthPng(path, *camera);
  if (!image.ok()) return image.status();
  return ScanFile{.scan = *std::move(image)};
}

}  // namespace graspdb::client
