#include "recognition/scene/image_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace graspdb::recognition {
namespace {

// What hides a surface by less is seldom another object, m: the scene goes through the model.
constexpr float kCloseM = 0.02F;

enum class Border { kUnknown, kEnds, kSmooth };

// What the scene does beside the point `p` of an outline. Depth cameras make objects wider by some
// millimetres, and the outline of a thinned surface is inside of it: an end up to three steps
// outside counts.
Border Beside(const Frame& frame, const Eigen::Vector3f& p, const Eigen::Vector3f& outward,
              const ImageEvidenceParameters& parameters) {
  const float pixel_m = p.z() / static_cast<float>(frame.camera.fx);
  const float beside = std::max(parameters.beside_m, parameters.beside_px * pixel_m);
  const float step = 2 * ToleranceAt(frame, p.z(), parameters);
  const std::ptrdiff_t inner = frame.PixelOf(p - beside * outward);
  if (inner < 0) return Border::kUnknown;
  const auto here = static_cast<std::size_t>(inner);
  const float z = frame.depth[here];
  // Hidden, or nothing there, which is counted by the surface.
  if (z == 0 || std::abs(z - p.z()) > 2 * step) return Border::kUnknown;
  if (frame.role[here] != PixelRole::kObject) return Border::kUnknown;
  const Eigen::Vector3f& normal = frame.normals[here];
  if (normal.squaredNorm() == 0) return Border::kUnknown;
  const Eigen::Vector3f inside = frame.PointAt(here, z);
  Border out = Border::kUnknown;
  for (const float far : {1.0F, 1.8F, 2.6F}) {
    const std::ptrdiff_t outer = frame.PixelOf(p + far * beside * outward);
    if (outer < 0) return out;
    const auto there = static_cast<std::size_t>(outer);
    const float z_out = frame.depth[there];
    if (z_out == 0) {
      // It may end there where not even the table is measured.
      if (!frame.table) out = Border::kUnknown;
      continue;
    }
    const Eigen::Vector3f way = frame.PointAt(there, z_out) - inside;
    const float above = normal.dot(way);
    // Something in front of the surface begins there.
    if (above > step && z_out < p.z() - step) return out;
    if (above < -step || frame.role[there] == PixelRole::kTable) return Border::kEnds;
    if (frame.role[there] != PixelRole::kObject) return out;
    const Eigen::Vector3f& other = frame.normals[there];
    if (other.squaredNorm() == 0) continue;
    // Another object begins at a concave crease; a convex one is an edge of the same object.
    const bool is_crease = normal.dot(other) < parameters.max_crease_cosine;
    if (is_crease && (other - normal).dot(way) < 0) return Border::kEnds;
    out = Border::kSmooth;
  }
  return out;
}

}  // namespace

float ToleranceAt(const Frame& frame, float z, const ImageEvidenceParameters& parameters) {
  return std::max(parameters.tolerance_m, parameters.noise_factor * frame.NoiseAt(z));
}

float SurfaceEvidence::Score() const {
  const float there = seen + contradicted + table + 0.3F * unmeasured;
  if (there <= 0) return 0;
  // Of what could be seen, how much was; a mostly hidden object cannot be sure.
  const float visible = 1 - hidden;
  return seen / there * std::min(1.0F, visible / 0.4F);
}

SurfaceEvidence LookAtSurface(const Frame& frame, const ImageModel& model,
                              const ModelAspect& aspect, const Eigen::Isometry3f& sensor_object,
                              std::size_t max_points, float tolerance_factor,
                              const ImageEvidenceParameters& parameters) {
  SurfaceEvidence out;
  const std::size_t all = aspect.visible.size();
  const std::size_t wanted = std::min(max_points, all);
  const Eigen::Matrix3f& turn = sensor_object.linear();
  float squares = 0;
  float bends = 0;
  std::size_t count = 0;
  std::size_t contradicted = 0;
  std::size_t tilted = 0;
  std::size_t table = 0;
  std::size_t hidden = 0;
  std::size_t covered = 0;
  std::size_t unmeasured = 0;
  for (std::size_t k = 0; k < wanted; ++k) {
    const std::size_t i = aspect.visible[k * all / wanted];
    const Eigen::Vector3f p = sensor_object * model.surface.points[i];
    const Eigen::Vector3f n = turn * model.surface.normals[i];
    const float facing = -n.dot(p) / p.norm();
    if (facing < 0.1F) continue;
    count += 1;
    const std::ptrdiff_t at = frame.PixelOf(p);
    if (at < 0) {
      unmeasured += 1;
      continue;
    }
    const auto pixel = static_cast<std::size_t>(at);
    const float z = frame.depth[pixel];
    if (z == 0) {
      unmeasured += 1;
      continue;
    }
    const float tolerance = tolerance_factor * ToleranceAt(frame, p.z(), parameters);
    // Along the line of sight a slanted surface is farther away than across it.
    const float across = (z - p.z()) * std::max(facing, 0.35F);
    if (across < -tolerance) {
      hidden += 1;
      if (across > -kCloseM - tolerance) covered += 1;
    } else if (across <= tolerance && frame.role[pixel] == PixelRole::kTable) {
      table += 1;
    } else if (across <= tolerance && frame.role[pixel] == PixelRole::kBackground) {
      unmeasured += 1;  // outside of the region
    } else if (across > tolerance || frame.role[pixel] != PixelRole::kObject) {
      contradicted += 1;  // the camera looked through, or what is there is another object's
    } else {
      const Eigen::Vector3f& seen = frame.normals[pixel];
      if (seen.squaredNorm() > 0 && seen.dot(n) < parameters.min_normal_cosine) {
        contradicted += 1;
        tilted += 1;
      } else {
        out.seen_count += 1;
        bends += seen.squaredNorm() > 0 ? 1 - seen.dot(n) : 0;
        squares += across * across;
      }
    }
  }
  if (count == 0) return out;
  const auto n = static_cast<float>(count);
  out.seen = static_cast<float>(out.seen_count) / n;
  out.contradicted = static_cast<float>(contradicted) / n;
  out.tilted = static_cast<float>(tilted) / n;
  out.table = static_cast<float>(table) / n;
  out.covered = static_cast<float>(covered) / n;
  out.hidden = static_cast<float>(hidden) / n;
  out.unmeasured = static_cast<float>(unmeasured) / n;
  out.seen_area_m2 =
      out.seen * static_cast<float>(all) * model.surface_step_m * model.surface_step_m;
  if (out.seen_count > 0) {
    out.rms_m = std::sqrt(squares / static_cast<float>(out.seen_count));
    out.bend = bends / static_cast<float>(out.seen_count);
  }
  return out;
}

OutlineEvidence LookAtOutline(const Frame& frame, const ModelAspect& aspect,
                              const Eigen::Isometry3f& sensor_object,
                              const ImageEvidenceParameters& parameters) {
  OutlineEvidence out;
  std::size_t smooth = 0;
  for (std::size_t k = 0; k < aspect.outline.size(); ++k) {
    const Border border = Beside(frame, sensor_object * aspect.outline[k],
                                 sensor_object.linear() * aspect.outward[k], parameters);
    out.count += border != Border::kUnknown ? 1 : 0;
    smooth += border == Border::kSmooth ? 1 : 0;
  }
  if (out.count == 0) return out;
  const auto known = static_cast<float>(out.count);
  out.smooth = static_cast<float>(smooth) / known;
  out.unknown = 1 - known / static_cast<float>(aspect.outline.size());
  return out;
}

const ModelAspect& AspectAt(const PairModel& model, const Eigen::Isometry3f& sensor_object) {
  const Eigen::Vector3f sensor =
      -(sensor_object.linear().transpose() * sensor_object.translation());
  return model.AspectFrom((sensor - model.center).normalized());
}

float ClearanceOver(const Plane& table, const ImageModel& model,
                    const Eigen::Isometry3f& sensor_object) {
  const Eigen::Vector3f normal = table.normal.cast<float>();
  const Eigen::Vector3f up = sensor_object.linear().transpose() * normal;
  constexpr std::size_t kEnough = 400;
  const Points& points = model.surface.points;
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kEnough);
  float lowest = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < points.size(); i += stride) {
    lowest = std::min(lowest, up.dot(points[i]));
  }
  return lowest + normal.dot(sensor_object.translation()) - static_cast<float>(table.offset);
}

}  // namespace graspdb::recognition
