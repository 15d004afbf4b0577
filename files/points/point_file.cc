#include "files/points/point_file.h"

#include <cstdint>
#include <limits>
#include <string>
#include <system_error>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/points/pcd_header.h"
#include "files/points/pcd_points.h"
#include "files/points/ply_file.h"

namespace graspdb::files {
namespace {

namespace fs = std::filesystem;

absl::Status CheckReadable(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    return absl::NotFoundError(
        absl::StrCat(path.string(), " does not exist; check the path of the point file"));
  }
  if (fs::is_directory(status)) {
    return absl::InvalidArgumentError(
        absl::StrCat(path.string(), " is a folder; name a .pcd or .ply file in it"));
  }
  if (!fs::is_regular_file(status)) {
    return absl::InvalidArgumentError(
        absl::StrCat(path.string(), " is not a regular file; name a .pcd or .ply file"));
  }
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (!error && bytes == 0) {
    return absl::InvalidArgumentError(
        absl::StrCat(path.string(), " is empty; capture or copy the cloud again"));
  }
  return absl::OkStatus();
}

absl::StatusOr<PointFile> ReadPcd(const fs::path& path) {
  ASSIGN_OR_RETURN(PcdHeader header, ReadPcdHeader(path));
  RETURN_IF_ERROR(CheckPcdBody(path, header));
  ASSIGN_OR_RETURN(PointFile file, DecodePcd(path, header));
  file.sensor_pose = header.sensor_pose;
  return file;
}

// Converts all encodings of "no measurement" to NaN.
void MarkMissing(recognition::Points& points) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (Eigen::Vector3f& p : points) {
    if (!p.allFinite() || p.isZero(0)) p.setConstant(kNaN);
  }
}

}  // namespace

absl::StatusOr<PointFile> ReadPointFile(const fs::path& path) {
  const std::string extension = absl::AsciiStrToLower(path.extension().string());
  RETURN_IF_ERROR(CheckReadable(path));
  if (extension != ".pcd" && extension != ".ply") {
    return absl::InvalidArgumentError(absl::StrCat(
        path.string(), " ends neither in .pcd nor in .ply; convert it to one of them"));
  }
  absl::StatusOr<PointFile> file = extension == ".pcd" ? ReadPcd(path) : ReadPly(path);
  if (file.ok()) MarkMissing(file->points);
  return file;
}

absl::Status WritePcd(const fs::path& path, const PointFile& file, Durability durability) {
  const std::size_t count = file.points.size();
  if (count == 0 || count > kMaxPoints) {
    return absl::InvalidArgumentError(absl::StrCat(
        "cannot write ", count, " points to ", path.string(), "; a file has 1 to ", kMaxPoints));
  }
  const std::int64_t grid = std::int64_t{file.width} * file.height;
  if (file.width < 1 || file.height < 1 || grid != static_cast<std::int64_t>(count)) {
    return absl::InvalidArgumentError(absl::StrCat("cannot write ", path.string(), ": ", count,
                                                   " points are not ", file.width, " x ",
                                                   file.height));
  }
  if (!file.normals.empty() && file.normals.size() != count) {
    return absl::InvalidArgumentError(absl::StrCat("cannot write ", path.string(), ": ",
                                                   file.normals.size(), " normals for ", count,
                                                   " points; give one each or none"));
  }
  return WriteFileAtomically(path, EncodePcd(file), durability);
}

}  // namespace graspdb::files
