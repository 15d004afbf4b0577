#include "client/cell/sensors/genicam/camera_features.h"

#include <cstddef>

namespace graspdb::client {

bool CameraFeatures::IsAvailable(const char* name) const {
  GlibError error;
  return arv_camera_is_feature_available(camera_, name, error.out()) != FALSE && error.ok();
}

std::optional<double> CameraFeatures::Number(const char* name) const {
  if (!IsAvailable(name)) return std::nullopt;
  {
    GlibError error;
    const double value = arv_camera_get_float(camera_, name, error.out());
    if (error.ok()) return value;
  }
  // Of some cameras a feature that the convention has as a float is an integer.
  GlibError error;
  const auto value = static_cast<double>(arv_camera_get_integer(camera_, name, error.out()));
  return error.ok() ? std::optional(value) : std::nullopt;
}

std::optional<std::string> CameraFeatures::Text(const char* name) const {
  if (!IsAvailable(name)) return std::nullopt;
  GlibError error;
  const char* value = arv_camera_get_string(camera_, name, error.out());
  if (!error.ok() || value == nullptr) return std::nullopt;
  return value;
}

bool CameraFeatures::IsTrue(const char* name) const {
  if (!IsAvailable(name)) return false;
  GlibError error;
  return arv_camera_get_boolean(camera_, name, error.out()) != FALSE && error.ok();
}

bool CameraFeatures::Set(const char* name, const char* value) const {
  if (!IsAvailable(name)) return false;
  GlibError error;
  arv_camera_set_string(camera_, name, value, error.out());
  return error.ok();
}

RangeGeometry ReadRangeGeometry(const CameraFeatures& features) {
  RangeGeometry out;
  out.output_mode = features.Text("Scan3dOutputMode").value_or("");
  out.coordinate_system = features.Text("Scan3dCoordinateSystem").value_or("");
  out.distance_unit = features.Text("Scan3dDistanceUnit").value_or("");
  constexpr const char* kCoordinates[] = {"CoordinateA", "CoordinateB", "CoordinateC"};
  for (std::size_t i = 0; i < out.axes.size(); ++i) {
    features.Set("Scan3dCoordinateSelector", kCoordinates[i]);
    RangeAxis& axis = out.axes[i];
    axis.scale = features.Number("Scan3dCoordinateScale");
    axis.offset = features.Number("Scan3dCoordinateOffset").value_or(0);
    if (features.IsTrue("Scan3dInvalidDataFlag")) {
      axis.invalid = features.Number("Scan3dInvalidDataValue");
    }
  }
  out.focal_length = features.Number("Scan3dFocalLength").value_or(0);
  out.aspect_ratio = features.Number("Scan3dAspectRatio").value_or(1);
  out.principal_u = features.Number("Scan3dPrincipalPointU").value_or(0);
  out.principal_v = features.Number("Scan3dPrincipalPointV").value_or(0);
  out.baseline_m = features.Number("Scan3dBaseline").value_or(0);
  return out;
}

}  // namespace graspdb::client
