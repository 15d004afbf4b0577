#include "files/scan_file.h"

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/depth/depth_png.h"
#include "files/messages/scan_message.h"
#include "files/points/point_file.h"

namespace graspdb::files {
namespace {

std::string ExtensionOf(const std::filesystem::path& path) {
  return absl::AsciiStrToLower(path.extension().string());
}

// The measured points of an image, sensor frame, m. INVALID_ARGUMENT where the lens maps no ray to
// much of the image.
absl::StatusOr<recognition::Points> UndistortedPoints(const v1::DepthImage& image,
                                                      const Lens& lens) {
  constexpr double kMaxShareWithoutRay = 0.02;
  ASSIGN_OR_RETURN(const recognition::Points pinhole, PointsFromMessage(image));
  recognition::Points out;
  double without_ray = 0;
  for (const Eigen::Vector3f& p : pinhole) {
    if (!p.allFinite()) continue;
    const Eigen::Vector2d place = p.head<2>().cast<double>() / static_cast<double>(p.z());
    const std::optional<Eigen::Vector2d> ray = Undistorted(lens, place);
    if (ray) {
      out.emplace_back(ray->homogeneous().cast<float>() * p.z());
    } else {
      ++without_ray;
    }
  }
  if (without_ray <= kMaxShareWithoutRay * static_cast<double>(out.size())) return out;
  return absl::InvalidArgumentError(
      "cannot be undistorted: its camera's coefficients fold the image; check their order, or use "
      "the rectified image");
}

}  // namespace

bool IsScanFile(const std::filesystem::path& path) {
  const std::string extension = ExtensionOf(path);
  return extension == ".pcd" || extension == ".ply" || extension == ".png";
}

absl::StatusOr<ScanFile> ReadScanFile(const std::filesystem::path& path) {
  if (ExtensionOf(path) != ".png") {
    ASSIGN_OR_RETURN(const PointFile file, ReadPointFile(path));
    return ScanFile{.scan = CloudMessage(file.points, file.image_width()),
                    .sensor_pose = file.sensor_pose};
  }
  ASSIGN_OR_RETURN(const DepthPngCamera camera,
                   ReadIntrinsics(path.parent_path() / kIntrinsicsFile));
  ASSIGN_OR_RETURN(v1::DepthImage image, ReadDepthPng(path, camera));
  if (!camera.lens.is_distorted()) return ScanFile{.scan = std::move(image)};
  const absl::StatusOr<recognition::Points> points = UndistortedPoints(image, camera.lens);
  if (points.ok()) return ScanFile{.scan = CloudMessage(*points, 0)};
  return absl::Status(points.status().code(),
                      absl::StrCat(path.string(), " ", points.status().message()));
}

}  // namespace graspdb::files
