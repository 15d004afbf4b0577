#include "tests/fuzz/open_issues.h"

#include <cmath>

#include "server/scan_from_proto.h"

namespace graspdb::fuzz {
namespace {

constexpr float kWidestM = 2;
constexpr float kNearestM = 0.02F;
constexpr double kFarthestPoseM = 10;
constexpr std::size_t kMostPoints = 200'000;

bool IsFar(const v1::Vector3& at) {
  return std::abs(at.x()) > kFarthestPoseM || std::abs(at.y()) > kFarthestPoseM ||
         std::abs(at.z()) > kFarthestPoseM;
}

bool IsFar(const v1::AxisAlignedBox& box) { return IsFar(box.min()) || IsFar(box.max()); }

bool IsWide(const recognition::Points& points) {
  for (const Eigen::Vector3f& p : points) {
    if (!p.allFinite() || p.isZero(0)) continue;
    if (p.cwiseAbs().maxCoeff() > kWidestM || p.norm() < kNearestM) return true;
  }
  return false;
}

bool IsWide(const v1::PointCloud& cloud) {
  recognition::Scan scan;
  return server::ReadCloud(cloud, kMostPoints, "", &scan).ok() && IsWide(scan.points);
}

bool IsWide(const v1::DepthImage& image) {
  recognition::Scan scan;
  if (!server::ReadDepthImage(image, kMostPoints, "", &scan).ok()) return false;
  const auto& [counts, camera, unit] = scan.depth_image;
  recognition::Points points;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto column = static_cast<double>(i % static_cast<std::size_t>(camera.width));
    const auto row = static_cast<double>(i / static_cast<std::size_t>(camera.width));
    const double depth = counts[i] * unit;
    const Eigen::Vector3d p((column - camera.cx) / camera.fx * depth,
                            (row - camera.cy) / camera.fy * depth, depth);
    points.push_back(p.cwiseMax(-1e6).cwiseMin(1e6).cast<float>());
  }
  return IsWide(points);
}

}  // namespace

bool IsOpenIssue(const v1::RecognizeRequest& request) {
  return IsFar(request.sensor_pose().position()) || IsFar(request.region_of_interest()) ||
         IsWide(request.cloud()) || IsWide(request.depth_image());
}

bool IsOpenIssue(const Uploads& uploads) {
  for (const v1::UploadViewsRequest& request : uploads.views()) {
    const v1::View& view = request.view();
    if (IsFar(view.sensor_pose().position()) || IsFar(view.object_pose().position()) ||
        IsFar(request.region_of_interest()) || IsWide(view.cloud())) {
      return true;
    }
  }
  return false;
}

bool IsOpenIssue(const Operation& operation) {
  for (const v1::Cell* cell : {&operation.create_cell().cell(), &operation.update_cell().cell()}) {
    if (IsFar(cell->sensor_pose().position()) || IsFar(cell->region_of_interest())) return true;
  }
  for (const v1::RecognizeStreamRequest& frame : operation.recognize_stream().frames()) {
    if (IsOpenIssue(frame.request())) return true;
  }
  return IsOpenIssue(operation.recognize()) || IsOpenIssue(operation.upload_views());
}

bool IsOpenIssue(const StoredDatabase& database) {
  for (const StoredRecord& record : database.records()) {
    v1::PointCloud cloud;
    cloud.set_point_stride(12);
    for (int axis = 0; axis < 3; ++axis) {
      v1::PackedElementField& field = *cloud.add_fields();
      field.set_name(std::string(1, "xyz"[axis]));
      field.set_offset(4 * axis);
      field.set_type(v1::PackedElementField::NUMERIC_TYPE_FLOAT32);
    }
    cloud.set_data(record.floats().substr(0, record.floats().size() / 12 * 12));
    if (IsWide(cloud) || IsFar(record.view().sensor_pose().position()) ||
        IsFar(record.view().object_pose().position())) {
      return true;
    }
  }
  for (const storage::IndexBlock& block : database.index_blocks()) {
    for (const double number : block.poses()) {
      if (std::abs(number) > kFarthestPoseM) return true;
    }
  }
  return false;
}

}  // namespace graspdb::fuzz
