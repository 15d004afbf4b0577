#include "server/requests/scan_from_proto.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "server/base/errors.h"

namespace graspdb::server {
namespace {

using Field = v1::PackedElementField;
static_assert(std::endian::native == std::endian::little, "packed data is little-endian");

// Depth cameras measure up to some metres; a median beyond this, m, means another unit.
constexpr float kMaxMedianDistance = 50;
// Coordinates, m, of points that are nearer than that, and whose squares do not overflow.
constexpr float kNear = 25;
constexpr int kMaxStride = 4096;
// A saturated count of a depth image, which is no measurement.
constexpr std::uint16_t kNoCount = 65535;
// Number of points for the check of the unit.
constexpr std::size_t kUnitSampleSize = 1000;

int SizeOf(Field::NumericType type) {
  switch (type) {
    case Field::NUMERIC_TYPE_FLOAT32:
      return 4;
    case Field::NUMERIC_TYPE_FLOAT64:
      return 8;
    default:
      return 0;
  }
}

// One component of all points; the type is a template parameter, since a check in the loop would
// cost more than the reading.
template <typename Number>
void ReadComponent(const char* at, std::size_t stride, Eigen::Index axis,
                   recognition::Points* points) {
  for (Eigen::Vector3f& point : *points) {
    Number value = 0;
    std::memcpy(&value, at, sizeof(value));
    point[axis] = static_cast<float>(value);
    at += stride;
  }
}

// The field of the given name, checked against the stride.
absl::StatusOr<const Field*> FindField(const v1::PointCloud& cloud, std::string_view name,
                                       std::string_view path) {
  for (int i = 0; i < cloud.fields_size(); ++i) {
    const Field& field = cloud.fields(i);
    if (field.name() != name) continue;
    const std::string at = absl::StrCat(std::string(path), ".fields[", i, "]");
    const int size = SizeOf(field.type());
    if (size == 0) return InvalidField(FieldPath(at, "type"), "must be FLOAT32 or FLOAT64");
    if (field.offset() < 0 || field.offset() > cloud.point_stride() - size) {
      return InvalidField(FieldPath(at, "offset"),
                          absl::StrCat("is ", field.offset(), "; the component must end within ",
                                       "the stride of ", cloud.point_stride(), " bytes"));
    }
    return &field;
  }
  return InvalidField(FieldPath(path, "fields"),
                      absl::StrCat("have no \"", std::string(name), "\"; x, y and z are required"));
}

absl::Status TooManyPoints(std::size_t count, std::size_t max_points, std::string_view path) {
  return InvalidField(path, absl::StrCat("has ", count, " points; this server takes at most ",
                                         max_points, " (--max-points)"));
}

// Eigen scales the coordinates against overflow, which takes longer than all the rest of the check.
// Where that is not needed, it only changes the last bits of a distance that has no influence.
float RangeOf(const Eigen::Vector3f& p) {
  return p.cwiseAbs().maxCoeff() < kNear ? p.norm() : p.stableNorm();
}

// Distances of every `step`-th measured point, m.
std::vector<float> RangesOf(const recognition::Scan& scan, std::size_t step) {
  std::vector<float> out;
  out.reserve(scan.size() / step + 1);
  for (std::size_t i = 0; i < scan.size(); i += step) {
    const Eigen::Vector3f p = scan.PointAt(i);
    if (p.allFinite() && !p.isZero(0)) out.push_back(RangeOf(p));
  }
  return out;
}

// Checks that there are measurements, in metres. A wrong unit affects all points, so a few are
// enough.
absl::Status CheckMeasurements(const recognition::Scan& scan, std::string_view path) {
  std::vector<float> ranges =
      RangesOf(scan, std::max<std::size_t>(1, scan.size() / kUnitSampleSize));
  if (ranges.empty()) ranges = RangesOf(scan, 1);
  if (ranges.empty()) {
    return InvalidField(path, absl::StrCat("has no measurement: all ", scan.size(),
                                           " points are NaN, infinite or zero"));
  }
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
  std::nth_element(ranges.begin(), middle, ranges.end());
  if (*middle > kMaxMedianDistance) {
    return InvalidField(path,
                        absl::StrCat("has a median distance of ", *middle,
                                     " m; coordinates are in metres, are these millimetres?"));
  }
  return absl::OkStatus();
}

absl::StatusOr<recognition::CameraIntrinsics> CameraFromProto(const v1::CameraIntrinsics& camera,
                                                              std::size_t max_points,
                                                              std::string_view path) {
  if (camera.width() <= 0 || camera.height() <= 0) {
    return InvalidField(path, "must have a positive width and height");
  }
  const std::size_t count =
      static_cast<std::size_t>(camera.width()) * static_cast<std::size_t>(camera.height());
  if (count > max_points) return TooManyPoints(count, max_points, path);
  const std::array<double, 4> values = {camera.fx(), camera.fy(), camera.cx(), camera.cy()};
  const bool finite =
      std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  if (!finite || camera.fx() <= 0 || camera.fy() <= 0) {
    return InvalidField(path, "must have finite values and positive focal lengths");
  }
  return recognition::CameraIntrinsics{camera.width(), camera.height(), camera.fx(),
                                       camera.fy(),    camera.cx(),     camera.cy()};
}

absl::Status ReadCloud(const v1::PointCloud& cloud, std::size_t max_points, std::string_view path,
                       recognition::Scan* scan) {
  const int stride = cloud.point_stride();
  if (stride <= 0 || stride > kMaxStride) {
    return InvalidField(FieldPath(path, "point_stride"),
                        absl::StrCat("is ", stride, "; it must lie in 1 to 4096 bytes"));
  }
  const auto step = static_cast<std::size_t>(stride);
  if (cloud.data().empty() || cloud.data().size() % step != 0) {
    return InvalidField(
        FieldPath(path, "data"),
        absl::StrCat("has ", cloud.data().size(),
                     " bytes, which is no positive multiple of the stride of ", stride));
  }
  const std::size_t count = cloud.data().size() / step;
  if (count > max_points) return TooManyPoints(count, max_points, path);
  std::array<const Field*, 3> fields{};
  constexpr std::array<std::string_view, 3> kNames = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ASSIGN_OR_RETURN(const Field* field, FindField(cloud, kNames[axis], path));
    fields[axis] = field;
  }
  scan->points.resize(count);
  scan->width = cloud.width();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const char* first = cloud.data().data() + fields[axis]->offset();
    const auto read = fields[axis]->type() == Field::NUMERIC_TYPE_FLOAT64 ? &ReadComponent<double>
                                                                          : &ReadComponent<float>;
    read(first, step, static_cast<Eigen::Index>(axis), &scan->points);
  }
  return CheckMeasurements(*scan, path);
}

absl::Status ReadDepthImage(const v1::DepthImage& image, std::size_t max_points,
                            std::string_view path, recognition::Scan* scan) {
  ASSIGN_OR_RETURN(recognition::CameraIntrinsics camera,
                   CameraFromProto(image.intrinsics(), max_points, FieldPath(path, "intrinsics")));
  const std::size_t count =
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  if (image.data().size() != 2 * count) {
    return InvalidField(FieldPath(path, "data"),
                        absl::StrCat("has ", image.data().size(), " bytes; ", camera.width, " x ",
                                     camera.height, " pixels need ", 2 * count));
  }
  const double unit = image.depth_unit_m() == 0 ? 0.001 : image.depth_unit_m();
  if (!(unit > 0 && unit <= 0.1)) {
    return InvalidField(FieldPath(path, "depth_unit_m"), "must lie in 0 to 0.1 m");
  }
  std::vector<std::uint16_t> depth(count);
  std::memcpy(depth.data(), image.data().data(), image.data().size());
  std::ranges::replace(depth, kNoCount, std::uint16_t{0});
  scan->depth_image = {std::move(depth), camera, unit};
  return CheckMeasurements(*scan, path);
}

}  // namespace

absl::Status ReadScan(const v1::RecognizeRequest& request, std::size_t max_points,
                      recognition::Scan* scan) {
  switch (request.scan_case()) {
    case v1::RecognizeRequest::kCloud:
      return ReadCloud(request.cloud(), max_points, "cloud", scan);
    case v1::RecognizeRequest::kDepthImage:
      return ReadDepthImage(request.depth_image(), max_points, "depth_image", scan);
    case v1::RecognizeRequest::SCAN_NOT_SET:
      break;
  }
  return InvalidField("scan", "is missing: give a cloud or a depth_image");
}

absl::Status ReadScan(const v1::View& view, std::size_t max_points, recognition::Scan* scan) {
  if (view.has_cloud() && view.has_depth_image()) {
    return InvalidField("view", "has both a cloud and a depth_image; give one of them");
  }
  if (view.has_cloud()) return ReadCloud(view.cloud(), max_points, "view.cloud", scan);
  if (view.has_depth_image()) {
    return ReadDepthImage(view.depth_image(), max_points, "view.depth_image", scan);
  }
  return InvalidField("view", "has neither a cloud nor a depth_image; give one of them");
}

v1::PointCloud PointsToProto(const recognition::Points& points) {
  v1::PointCloud out;
  out.set_point_stride(12);
  int offset = 0;
  for (const char* name : {"x", "y", "z"}) {
    Field* field = out.add_fields();
    field->set_name(name);
    field->set_offset(offset);
    field->set_type(Field::NUMERIC_TYPE_FLOAT32);
    offset += 4;
  }
  static_assert(sizeof(Eigen::Vector3f) == 12);
  out.mutable_data()->assign(reinterpret_cast<const char*>(points.data()), points.size() * 12);
  return out;
}

}  // namespace graspdb::server
