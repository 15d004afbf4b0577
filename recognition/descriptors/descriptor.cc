#include "recognition/descriptors/descriptor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "recognition/descriptors/gsh288.h"
#include "recognition/descriptors/histogram.h"
#include "recognition/descriptors/vfh308.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
constexpr double kPi = std::numbers::pi;
// Coordinates of about a metre are rounded to 6e-8 m. Rounding determines the direction of vectors
// shorter than kNoDirection, and directions with a smaller sine between them than kNoFrame span no
// frame that is stable under a rigid motion.
constexpr double kNoDirection = 1e-5;  // m
constexpr double kNoFrame = 1e-4;
// Clouds that are smaller than this are one place, m; mean normals that are shorter have
// no direction.
constexpr double kSamePlace = 1e-6;

struct Name {
  DescriptorKind kind;
  std::string_view name;
  int size;
};
constexpr std::array<Name, 4> kNames = {{{DescriptorKind::kVfh263, "vfh263", 263},
                                         {DescriptorKind::kMvfh300, "mvfh300", 300},
                                         {DescriptorKind::kVfh308, "vfh308", 308},
                                         {DescriptorKind::kGsh288, "gsh288", 288}}};

// Centroid p_c and unit mean normal n_c.
struct Center {
  Vector3d position;
  Vector3d normal;
};

bool IsFinite(const OrientedCloud& cloud) {
  const auto finite = [](const Eigen::Vector3f& v) { return v.allFinite(); };
  return std::ranges::all_of(cloud.points, finite) && std::ranges::all_of(cloud.normals, finite);
}

absl::StatusOr<Center> FindCenter(const OrientedCloud& cloud, const Vector3d& viewpoint) {
  const auto count = static_cast<double>(cloud.points.size());
  Vector3d sum = Vector3d::Zero();
  Vector3d normals = Vector3d::Zero();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    sum += cloud.points[i].cast<double>();
    normals += cloud.normals[i].cast<double>();
  }
  Center center{sum / count, normals / count};
  double farthest = 0;
  for (const auto& p : cloud.points) {
    farthest = std::max(farthest, (p.cast<double>() - center.position).norm());
  }
  if (farthest < kSamePlace) {
    return absl::FailedPreconditionError(
        "all points coincide and have no shape to describe; check the scan");
  }
  if (center.normal.norm() < kSamePlace) center.normal = viewpoint - center.position;
  if (center.normal.norm() < kSamePlace) center.normal = Vector3d::UnitZ();
  center.normal.normalize();
  return center;
}

// The two axes that complete u = n_c to a Darboux frame, after a direction d
// (eqs. 2, 3 and 9, 10; all of unit length). False where d is parallel to u.
bool CompleteFrame(const Vector3d& u, const Vector3d& d, Vector3d* v, Vector3d* w) {
  *v = d.cross(u);
  const double length = v->norm();
  if (length < kNoFrame) return false;
  *v /= length;
  *w = u.cross(*v);
  return true;
}

// The histograms of one Darboux frame: cos(alpha), cos(phi), theta.
struct FrameHistograms {
  explicit FrameHistograms(int bins)
      : alpha(-1, 1, bins), phi(-1, 1, bins), theta(-kPi, kPi, bins) {}
  Histogram alpha;
  Histogram phi;
  Histogram theta;

  void Add(const Vector3d& u, const Vector3d& d, const Vector3d& to_point, const Vector3d& normal) {
    phi.Add(normal.dot(to_point));  // eqs. 6, 12
    Vector3d v;
    Vector3d w;
    if (!CompleteFrame(u, d, &v, &w)) return;
    alpha.Add(v.dot(normal));                             // eqs. 4, 11
    theta.Add(std::atan2(w.dot(normal), u.dot(normal)));  // eqs. 7, 13
  }
};

// Appends the parts, each with the same share of mass 1.
Descriptor Concatenate(std::initializer_list<const Histogram*> parts) {
  std::size_t size = 0;
  for (const Histogram* part : parts) size += part->size();
  Descriptor out(size);
  std::size_t at = 0;
  for (const Histogram* part : parts) {
    part->Write(1.0 / static_cast<double>(parts.size()), std::span(out).subspan(at, part->size()));
    at += part->size();
  }
  return out;
}

// The shape part (eqs. 1 to 4, 6, 7), and either the viewpoint part of VFH
// (eq. 5) or that of MVFH (eqs. 8 to 13).
Descriptor ViewpointHistogram(const OrientedCloud& cloud, const Vector3d& viewpoint,
                              const Center& center, DescriptorKind kind) {
  FrameHistograms shape(45);
  FrameHistograms view(55);
  Histogram beta(-1, 1, 128);
  const Vector3d to_viewpoint = (viewpoint - center.position).normalized();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Vector3d p = cloud.points[i].cast<double>();
    const Vector3d normal = cloud.normals[i].cast<double>();
    beta.Add(normal.dot(to_viewpoint));  // eq. 5
    const Vector3d from_center = p - center.position;
    const double distance = from_center.norm();
    if (distance < kNoDirection) continue;
    const Vector3d direction = from_center / distance;
    shape.Add(center.normal, direction, direction, normal);
    view.Add(center.normal, (viewpoint - p).normalized(), direction, normal);
  }
  if (kind == DescriptorKind::kVfh263) {
    return Concatenate({&shape.alpha, &shape.phi, &shape.theta, &beta});
  }
  return Concatenate({&shape.alpha, &shape.phi, &shape.theta, &view.alpha, &view.phi, &view.theta});
}

}  // namespace

std::string_view DescriptorName(DescriptorKind kind) {
  for (const Name& n : kNames) {
    if (n.kind == kind) return n.name;
  }
  return "";
}

std::optional<DescriptorKind> DescriptorFromName(std::string_view name) {
  for (const Name& n : kNames) {
    if (n.name == name) return n.kind;
  }
  return std::nullopt;
}

std::vector<std::string> DescriptorNames() {
  std::vector<std::string> out;
  out.reserve(kNames.size());
  for (const Name& n : kNames) out.emplace_back(n.name);
  return out;
}

int DescriptorSize(DescriptorKind kind) {
  for (const Name& n : kNames) {
    if (n.kind == kind) return n.size;
  }
  return 0;
}

absl::StatusOr<Descriptor> Describe(const OrientedCloud& cloud, const Vector3d& viewpoint,
                                    DescriptorKind kind) {
  return Describe(cloud, Pose(Eigen::Translation3d(viewpoint)), kind);
}

absl::StatusOr<Descriptor> Describe(const OrientedCloud& cloud, const Pose& sensor,
                                    DescriptorKind kind) {
  const Vector3d viewpoint = sensor.translation();
  if (cloud.points.size() < kMinDescriptorPoints) {
    return absl::FailedPreconditionError(absl::StrCat("the cloud has ", cloud.points.size(),
                                                      " points; a descriptor needs at least ",
                                                      kMinDescriptorPoints));
  }
  if (cloud.normals.size() != cloud.points.size()) {
    return absl::InvalidArgumentError("every point needs a normal");
  }
  if (!IsFinite(cloud) || !sensor.matrix().allFinite()) {
    return absl::InvalidArgumentError("points, normals and viewpoint must be finite");
  }
  absl::StatusOr<Center> center = FindCenter(cloud, viewpoint);
  if (!center.ok()) return center.status();
  if (kind == DescriptorKind::kGsh288) return DescribeGsh288(cloud, sensor);
  if (kind == DescriptorKind::kVfh308) return DescribeVfh308(cloud, viewpoint);
  return ViewpointHistogram(cloud, viewpoint, *center, kind);
}

std::string DescriptorParameters::Fingerprint() const {
  // The leading number is the version of the code that turns points into bins.
  return absl::StrFormat("2 %s voxel=%.6f normal=%.6f", DescriptorName(kind), voxel_size_m,
                         normal_radius_m);
}

}  // namespace graspdb::recognition
