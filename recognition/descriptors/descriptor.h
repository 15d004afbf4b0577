// Global descriptors of one object's points: the published baselines and our own.
//
// Sources: R. B. Rusu et al., "Fast 3D recognition and pose using the viewpoint
// feature histogram", IROS 2010 (VFH); C.-S. Chen, P.-C. Chen, C.-M. Hsu,
// "Three-dimensional object recognition and registration for robotic grasping
// systems using a modified viewpoint feature histogram", Sensors 2016 (MVFH);
// equation numbers are those of the latter.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"

namespace graspdb::recognition {

enum class DescriptorKind {
  kVfh263,   // 3 x 45 shape bins (eqs. 4, 6, 7) and 128 viewpoint bins (eq. 5).
  kMvfh300,  // 3 x 45 shape bins and 3 x 55 viewpoint bins (eqs. 11 to 13).
  kVfh308,   // As the Point Cloud Library 1.13 computes it, for comparison.
  kGsh288,   // Normals and positions against gravity and the line of sight, see gsh288.h.
};

// "vfh263", "mvfh300", "vfh308", "gsh288".
std::string_view DescriptorName(DescriptorKind kind);
std::optional<DescriptorKind> DescriptorFromName(std::string_view name);
// Names of all descriptors.
std::vector<std::string> DescriptorNames();

// Number of bins.
int DescriptorSize(DescriptorKind kind);

// The bins. VFH-263, MVFH-300 and GSH-288: every part has the same mass, the whole has
// mass 1. VFH-308: as PCL scales it, 100 a part.
using Descriptor = std::vector<float>;

// Minimum number of points of a descriptor.
inline constexpr std::size_t kMinDescriptorPoints = 10;

// Describes `cloud` (metres, any frame, unit normals) as seen by a sensor at `sensor`
// (T_cloud_sensor, metres). Does not depend on the order of the points nor on a
// rigid motion of cloud and sensor together; GSH-288 only on one that leaves z up.
//
// INVALID_ARGUMENT for non-finite values and for a point without a normal; FAILED_PRECONDITION for
// fewer than 10 points and for coincident points. Where the mean normal is zero, the direction from
// the centroid to the viewpoint replaces it, since normals are turned towards the sensor. A point
// on the centroid, or one with an undefined Darboux frame, is left out of the parts concerned.
absl::StatusOr<Descriptor> Describe(const OrientedCloud& cloud, const Pose& sensor,
                                    DescriptorKind kind);

// The same from the sensor's position alone, which suffices except for GSH-288 of an object
// straight below the sensor.
absl::StatusOr<Descriptor> Describe(const OrientedCloud& cloud, const Eigen::Vector3d& viewpoint,
                                    DescriptorKind kind);

// Parameters of stored clouds and their descriptors, the same for the whole catalogue: descriptors
// with different values are not comparable.
struct DescriptorParameters {
  DescriptorKind kind = DescriptorKind::kGsh288;
  // Edge of a voxel, m (paper, section 3.1: 0.3 cm).
  double voxel_size_m = 0.003;
  // Radius of the neighbourhood that a normal is fitted to, m.
  double normal_radius_m = 0.010;

  // All values as text; descriptors with equal fingerprints are comparable.
  std::string Fingerprint() const;
};

}  // namespace graspdb::recognition
