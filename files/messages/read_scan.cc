#include "files/messages/read_scan.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/messages/scan_message.h"

namespace graspdb::files {
namespace {

using Field = v1::PackedElementField;
static_assert(std::endian::native == std::endian::little, "packed data is little-endian");

// Depth cameras measure up to some metres; a median beyond this, m, means another unit.
constexpr float kMaxMedianDistance = 50;
// Coordinates, m, of points that are nearer than that, and whose squares do not overflow.
constexpr float kNear = 25;
constexpr int kMaxStride = 4096;
// Number of points for the check of the unit.
constexpr std::size_t kUnitSampleSize = 1000;

// The message at a path.
struct Place {
  const ScanRules& rules;
  std::string path;

  absl::Status Wrong(const std::string& description) const {
    return rules.wrong(path, description);
  }
  absl::Status WrongField(const std::string& field, const std::string& description) const {
    return rules.wrong(absl::StrCat(path, ".", field), description);
  }
};

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
absl::StatusOr<const Field*> FindField(const v1::PointCloud& cloud, const std::string& name,
                                       const Place& place) {
  for (int i = 0; i < cloud.fields_size(); ++i) {
    const Field& field = cloud.fields(i);
    if (field.name() != name) continue;
    const std::string at = absl::StrCat("fields[", i, "]");
    const int size = SizeOf(field.type());
    if (size == 0) return place.WrongField(at + ".type", "must be FLOAT32 or FLOAT64");
    if (field.offset() < 0 || field.offset() > cloud.point_stride() - size) {
      return place.WrongField(
          at + ".offset", absl::StrCat("is ", field.offset(), "; the component must end within ",
                                       "the stride of ", cloud.point_stride(), " bytes"));
    }
    return &field;
  }
  return place.WrongField("fields",
                          absl::StrCat("have no \"", name, "\"; x, y and z are required"));
}

// Eigen scales the coordinates against overflow, which takes longer than all the rest of the check.
// Where that is not needed, it only changes the last bits of a distance that has no influence.
float RangeOf(const Eigen::Vector3f& p) {
  return p.cwiseAbs().maxCoeff() < kNear ? p.norm() : p.stableNorm();
}

// Distances of every `step`-th measured point, m.
std::vector<float> RangesOf(const recognition::Scan& scan, std::size_t step) {
  std::vector<float> out;
  for (std::size_t i = 0; i < scan.size(); i += step) {
    const Eigen::Vector3f p = scan.PointAt(i);
    if (p.allFinite() && !p.isZero(0)) out.push_back(RangeOf(p));
  }
  return out;
}

// Checks that there are measurements, in metres. A wrong unit affects all points, so a few are
// enough.
absl::Status CheckMeasurements(const recognition::Scan& scan, const Place& place) {
  std::vector<float> ranges =
      RangesOf(scan, std::max<std::size_t>(1, scan.size() / kUnitSampleSize));
  if (ranges.empty()) ranges = RangesOf(scan, 1);
  if (ranges.empty()) {
    if (place.rules.allows_blank) return absl::OkStatus();
    return place.Wrong(
        absl::StrCat("has no measurement: all ", scan.size(), " points are NaN, infinite or zero"));
  }
  const auto middle = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
  std::nth_element(ranges.begin(), middle, ranges.end());
  if (*middle <= kMaxMedianDistance) return absl::OkStatus();
  return place.Wrong(absl::StrCat("has a median distance of ", *middle,
                                  " m; coordinates are in metres, are these millimetres?"));
}

absl::Status CheckCount(std::size_t count, const Place& place) {
  if (count <= place.rules.max_points) return absl::OkStatus();
  return place.Wrong(absl::StrCat("has ", count, " points; this server takes at most ",
                                  place.rules.max_points, " (--max-points)"));
}

absl::Status CheckCamera(const v1::CameraIntrinsics& camera, const Place& place) {
  if (camera.width() <= 0 || camera.height() <= 0) {
    return place.Wrong("must have a positive width and height");
  }
  RETURN_IF_ERROR(CheckCount(
      static_cast<std::size_t>(camera.width()) * static_cast<std::size_t>(camera.height()), place));
  const std::array<double, 4> values = {camera.fx(), camera.fy(), camera.cx(), camera.cy()};
  const bool finite = std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
  if (finite && camera.fx() > 0 && camera.fy() > 0) return absl::OkStatus();
  return place.Wrong("must have finite values and positive focal lengths");
}

}  // namespace

absl::Status ReadScan(const v1::PointCloud& cloud, const ScanRules& rules, std::string_view path,
                      recognition::Scan* scan) {
  const Place place{rules, std::string(path)};
  const int stride = cloud.point_stride();
  if (stride < rules.min_stride || stride > kMaxStride) {
    return place.WrongField(
        "point_stride", absl::StrCat("is ", stride, "; it must lie in ", rules.min_stride, " to ",
                                     kMaxStride, " bytes"));
  }
  const auto step = static_cast<std::size_t>(stride);
  if (cloud.data().empty() || cloud.data().size() % step != 0) {
    return place.WrongField(
        "data", absl::StrCat("has ", cloud.data().size(),
                             " bytes, which is no positive multiple of the stride of ", stride));
  }
  const std::size_t count = cloud.data().size() / step;
  RETURN_IF_ERROR(CheckCount(count, place));
  std::array<const Field*, 3> fields{};
  constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ASSIGN_OR_RETURN(fields[axis], FindField(cloud, kNames[axis], place));
  }
  scan->points.resize(count);
  scan->width = cloud.width();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const char* first = cloud.data().data() + fields[axis]->offset();
    const auto read = fields[axis]->type() == Field::NUMERIC_TYPE_FLOAT64 ? &ReadComponent<double>
                                                                          : &ReadComponent<float>;
    read(first, step, static_cast<Eigen::Index>(axis), &scan->points);
  }
  return CheckMeasurements(*scan, place);
}

absl::Status ReadScan(const v1::DepthImage& image, const ScanRules& rules, std::string_view path,
                      recognition::Scan* scan) {
  const Place place{rules, std::string(path)};
  RETURN_IF_ERROR(CheckCamera(image.intrinsics(), {rules, place.path + ".intrinsics"}));
  const recognition::CameraIntrinsics camera = FromMessage(image.intrinsics());
  const std::size_t count =
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  if (image.data().size() != 2 * count) {
    return place.WrongField(
        "data", absl::StrCat("has ", image.data().size(), " bytes; ", camera.width, " x ",
                             camera.height, " pixels need ", 2 * count));
  }
  const double unit = DepthUnit(image);
  if (!(unit > 0 && unit <= 0.1)) {
    return place.WrongField("depth_unit_m", "must lie in 0 to 0.1 m");
  }
  std::vector<std::uint16_t> depth(count);
  std::memcpy(depth.data(), image.data().data(), image.data().size());
  std::ranges::replace(depth, kNoCount, std::uint16_t{0});
  scan->depth_image = {std::move(depth), camera, unit};
  return CheckMeasurements(*scan, place);
}

}  // namespace graspdb::files
