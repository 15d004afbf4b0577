#include "client/cell/sensors/genicam/range_image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/messages/scan_message.h"

namespace graspdb::client {
namespace {

static_assert(std::endian::native == std::endian::little, "images are little-endian");

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
// Units that a depth image keeps.
constexpr double kMinUnitM = 1e-6;
constexpr double kMaxUnitM = 0.1;
// Depths that a camera measures, m; the contract ends at the far one.
constexpr double kNearM = 0.001;
constexpr double kFarM = 100;

absl::Status Unusable(const std::string& what) { return absl::FailedPreconditionError(what); }

std::size_t BytesOfPixel(RangeFormat format) {
  switch (format) {
    case RangeFormat::kC16:
      return 2;
    case RangeFormat::kC32f:
      return 4;
    case RangeFormat::kAbc16:
      return 6;
    case RangeFormat::kAbc32f:
      return 12;
  }
  return 0;
}

bool HasIntegers(RangeFormat format) {
  return format == RangeFormat::kC16 || format == RangeFormat::kAbc16;
}

bool IsCloud(RangeFormat format) {
  return format == RangeFormat::kAbc16 || format == RangeFormat::kAbc32f;
}

absl::Status CheckSize(const RangeImage& image) {
  const std::size_t bytes = BytesOfPixel(image.format);
  if (image.width > 0 && image.height > 0 &&
      image.data.size() / bytes / static_cast<std::size_t>(image.width) ==
          static_cast<std::size_t>(image.height) &&
      image.data.size() % (bytes * static_cast<std::size_t>(image.width)) == 0) {
    return absl::OkStatus();
  }
  return absl::DataLossError(absl::StrCat("an image of ", image.width, " x ", image.height,
                                          " pixels of ", bytes, " bytes came with ",
                                          image.data.size(), " bytes"));
}

absl::StatusOr<double> MetresOf(const std::string& unit) {
  if (unit.empty() || unit == "Millimeter") return 0.001;
  if (unit == "Inch") return 0.0254;
  if (unit == "Meter") return 1.0;  // of some vendors
  return Unusable(
      absl::StrCat("the camera measures in ", unit, " (Scan3dDistanceUnit); set it to Millimeter"));
}

// Whether values are disparities, after the mode was found usable for the format.
absl::StatusOr<bool> IsDisparity(const RangeGeometry& geometry, RangeFormat format) {
  const std::string& mode = geometry.output_mode;
  if (!geometry.coordinate_system.empty() && geometry.coordinate_system != "Cartesian") {
    return Unusable(absl::StrCat("the camera has ", geometry.coordinate_system,
                                 " coordinates (Scan3dCoordinateSystem); set it to Cartesian"));
  }
  if (IsCloud(format)) {
    if (mode.empty() || mode == "CalibratedABC_Grid" || mode == "CalibratedABC_PointCloud") {
      return false;
    }
    return Unusable(absl::StrCat("the camera's Scan3dOutputMode is ", mode,
                                 "; set it to CalibratedABC_Grid for this pixel format"));
  }
  if (mode == "DisparityC") return true;
  if (mode.empty() || mode == "CalibratedC" || mode == "ProjectedC") return false;
  return Unusable(absl::StrCat("the camera's Scan3dOutputMode is ", mode,
                               "; set it to CalibratedC or DisparityC for this pixel format"));
}

// Values of one axis to the unit of its scale.
class AxisReader {
 public:
  // FAILED_PRECONDITION for a scale or an offset that is missing or no number.
  static absl::StatusOr<AxisReader> Of(const RangeAxis& axis, RangeFormat format,
                                       const std::string& name, double metres) {
    if (!axis.scale && HasIntegers(format)) {
      return Unusable(absl::StrCat("the camera has no Scan3dCoordinateScale of ", name,
                                   "; choose a pixel format of floats"));
    }
    AxisReader out;
    out.scale_ = axis.scale.value_or(1) * metres;
    out.offset_ = axis.offset * metres;
    out.invalid_ = axis.invalid;
    if (std::isfinite(out.scale_) && out.scale_ != 0 && std::isfinite(out.offset_)) return out;
    return Unusable(absl::StrCat("the camera's Scan3dCoordinateScale or Scan3dCoordinateOffset of ",
                                 name, " is no usable number"));
  }

  // Metres or pixels; NaN where there is no measurement.
  double Read(double value) const {
    if (!std::isfinite(value) || (invalid_ && value == *invalid_)) return kNaN;
    return value * scale_ + offset_;
  }

  double scale() const { return scale_; }
  double offset() const { return offset_; }

 private:
  double scale_ = 1;
  double offset_ = 0;
  std::optional<double> invalid_;
};

double ValueAt(const char* at, bool is_integer) {
  if (is_integer) {
    std::uint16_t count = 0;
    std::memcpy(&count, at, sizeof(count));
    return count;
  }
  float value = 0;
  std::memcpy(&value, at, sizeof(value));
  return value;
}

absl::StatusOr<files::ScanMessage> CloudOf(const RangeImage& image, const RangeGeometry& geometry,
                                           double metres) {
  constexpr const char* kNames[] = {"CoordinateA", "CoordinateB", "CoordinateC"};
  std::vector<AxisReader> readers;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ASSIGN_OR_RETURN(const AxisReader reader,
                     AxisReader::Of(geometry.axes[axis], image.format, kNames[axis], metres));
    readers.push_back(reader);
  }
  const bool is_integer = HasIntegers(image.format);
  const std::size_t step = is_integer ? 2 : 4;
  recognition::Points points(image.data.size() / (3 * step));
  const char* at = image.data.data();
  for (Eigen::Vector3f& point : points) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double value = readers[static_cast<std::size_t>(axis)].Read(ValueAt(at, is_integer));
      point[axis] = static_cast<float>(value);
      at += step;
    }
    // An axis without a value of its own for "invalid" does not make the others valid.
    if (!point.allFinite() || !(point.z() > 0)) point.setConstant(kNaN);
  }
  return files::CloudMessage(points, image.width);
}

absl::StatusOr<recognition::CameraIntrinsics> IntrinsicsOf(const RangeImage& image,
                                                           const RangeGeometry& geometry) {
  const recognition::CameraIntrinsics out = {.width = image.width,
                                             .height = image.height,
                                             .fx = geometry.focal_length,
                                             .fy = geometry.focal_length * geometry.aspect_ratio,
                                             .cx = geometry.principal_u,
                                             .cy = geometry.principal_v};
  const bool finite = std::isfinite(out.fx) && std::isfinite(out.fy) && std::isfinite(out.cx) &&
                      std::isfinite(out.cy);
  if (finite && out.fx > 0 && out.fy > 0) return out;
  return Unusable(
      "the camera has no focal length (Scan3dFocalLength); give fx, fy, cx and cy in pixels, or "
      "choose a pixel format of points, such as ?format=Coord3D_ABC32f");
}

// Distances of disparities: focal length * baseline / disparity.
absl::StatusOr<double> DisparityFactor(const RangeGeometry& geometry,
                                       const recognition::CameraIntrinsics& camera) {
  const double factor = camera.fx * geometry.baseline_m;
  if (std::isfinite(factor) && factor > 0) return factor;
  return Unusable(
      "the camera sends disparities and has no Scan3dBaseline; set Scan3dOutputMode to "
      "CalibratedC");
}

absl::StatusOr<files::ScanMessage> DepthOf(const RangeImage& image, const RangeGeometry& geometry,
                                           bool is_disparity, double metres,
                                           const recognition::CameraIntrinsics& camera) {
  ASSIGN_OR_RETURN(
      const AxisReader reader,
      AxisReader::Of(geometry.axes[2], image.format, "CoordinateC", is_disparity ? 1 : metres));
  double factor = 0;
  if (is_disparity) {
    ASSIGN_OR_RETURN(factor, DisparityFactor(geometry, camera));
  }
  const bool is_integer = HasIntegers(image.format);
  const std::size_t step = BytesOfPixel(image.format);
  const std::size_t count = image.data.size() / step;
  const bool keeps_counts = is_integer && !is_disparity && reader.offset() == 0 &&
                            reader.scale() >= kMinUnitM && reader.scale() <= kMaxUnitM;
  std::vector<std::uint16_t> counts;
  std::vector<float> depths;
  (keeps_counts ? counts.reserve(count) : depths.reserve(count));
  float far = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = ValueAt(image.data.data() + i * step, is_integer);
    const double read = reader.Read(value);
    if (keeps_counts) {
      counts.push_back(read > 0 ? static_cast<std::uint16_t>(value) : std::uint16_t{0});
      continue;
    }
    const double depth = is_disparity && read > 0 ? factor / read : read;
    const bool is_measured = read > 0 && depth >= kNearM && depth <= kFarM;
    depths.push_back(is_measured ? static_cast<float>(depth) : 0);
    far = std::max(far, depths.back());
  }
  if (keeps_counts) return files::DepthMessage(counts, camera, reader.scale());
  return files::FineDepthMessage(depths, camera, far > 0 ? static_cast<double>(far) : 1);
}

}  // namespace

std::optional<RangeFormat> RangeFormatOf(std::uint32_t pixel_format) {
  for (const RangeFormat format :
       {RangeFormat::kC16, RangeFormat::kC32f, RangeFormat::kAbc16, RangeFormat::kAbc32f}) {
    if (static_cast<std::uint32_t>(format) == pixel_format) return format;
  }
  return std::nullopt;
}

absl::StatusOr<files::ScanMessage> ScanOfRange(
    const RangeImage& image, const RangeGeometry& geometry,
    const std::optional<recognition::CameraIntrinsics>& intrinsics) {
  RETURN_IF_ERROR(CheckSize(image));
  ASSIGN_OR_RETURN(const bool is_disparity, IsDisparity(geometry, image.format));
  // Disparities are pixels.
  ASSIGN_OR_RETURN(const double metres,
                   is_disparity ? absl::StatusOr<double>(1) : MetresOf(geometry.distance_unit));
  if (IsCloud(image.format)) return CloudOf(image, geometry, metres);
  recognition::CameraIntrinsics camera;
  if (intrinsics) {
    camera = *intrinsics;
  } else {
    ASSIGN_OR_RETURN(camera, IntrinsicsOf(image, geometry));
  }
  if (camera.width != image.width || camera.height != image.height) {
    return Unusable(absl::StrCat("the camera sends ", image.width, " x ", image.height,
                                 " pixels and its intrinsics are for ", camera.width, " x ",
                                 camera.height, "; correct them"));
  }
  return DepthOf(image, geometry, is_disparity, metres, camera);
}

}  // namespace graspdb::client
