// Every number that steers the recognition, with unit and default.
#pragma once

#include <string>

#include "recognition/descriptor.h"

namespace graspdb::recognition {

// What shapes a stored cloud and its descriptor. One for the whole catalogue:
// descriptors that were made with different values do not compare.
struct DescriptorParameters {
  DescriptorKind kind = DescriptorKind::kGsh288;
  // Edge of a voxel, m (paper, section 3.1: 0.3 cm).
  double voxel_size_m = 0.003;
  // Radius of the neighbourhood that a normal is fitted to, m.
  double normal_radius_m = 0.010;

  // Names all values; equal texts mean that descriptors compare.
  std::string Fingerprint() const;
};

// How an object's points are found in a frame. May differ from cell to cell.
struct SegmentationParameters {
  // Points farther from the sensor are left out, m: cells are smaller, and depth cameras for them
  // measure up to 6 m. Doubled, more of the room behind a cell costs time.
  double max_range_m = 10;
  // The longest side of what can be one object, m: what a robot lifts off a table. Doubled, a
  // segmented scan with stray points takes up to four times the memory.
  double max_object_size_m = 1;
  // Points nearer to the table plane than this belong to the table, m.
  double plane_distance_m = 0.006;
  // How far the table may be tilted against the world's z axis when the sensor
  // pose is known, rad.
  double plane_max_tilt_rad = 0.17;
  // How far the table may lie from z = 0 when the sensor pose is known, m.
  double plane_max_offset_m = 0.03;
  // A plane needs this share of the points in the region.
  double plane_min_share = 0.10;
  // Neighbours in the statistical outlier removal; 0 turns it off.
  int outlier_neighbor_count = 50;
  // Points whose mean neighbour distance lies more than so many standard
  // deviations above the mean are outliers.
  double outlier_deviation_factor = 2.0;
  // Clusters are farther apart than this, m.
  double cluster_tolerance_m = 0.015;
  // Clusters with fewer voxels than this are dirt; at least 10.
  int min_cluster_point_count = 50;
};

// Which error the alignment makes small.
enum class IcpMetric {
  kPointToPoint,  // Besl and McKay, as the paper cites it.
  kPointToPlane,  // Chen and Medioni; fewer iterations, the same minimum.
};

// How the nearest views are aligned and judged.
struct MatchingParameters {
  // Candidates that an answer lists.
  int candidate_count = 10;
  // Nearest views whose stable poses are aligned first; the hypothesis that explains the scan
  // best wins. 1 trusts the descriptor alone and aligns that view's cloud, as the paper does.
  int verified_view_count = 20;
  // Where these do not explain a segment, so many views are looked at in all: among 2,040 views no
  // more was found with all of them (ADR 15). Doubled, unknown objects take up to twice as long.
  int further_view_count = 300;
  // Of those the views that are looked at for all segments of a frame together; what is left is
  // counted as not tried. Four segments that nothing explains; doubled, the worst frame takes twice
  // as long.
  int further_view_budget = 1200;
  // When the search for what nothing explains ends in any case, s from the frame's beginning. Far
  // more than the budget takes, for a machine that is too busy.
  double search_ceiling_s = 2;
  IcpMetric metric = IcpMetric::kPointToPlane;
  int icp_iteration_count = 50;
  // Correspondences farther apart than this are never used, m.
  double max_correspondence_m = 0.03;
  // Distance at which two points stop supporting each other in the score, m.
  double support_distance_m = 0.008;
  // An alignment with a smaller share of corresponding points is rejected.
  double min_inlier_fraction = 0.3;
  // A detection that scores lower is unknown, 0 to 1.
  double min_score = 0.5;
  // A stable pose that has a threshold of its own is held to that in place of min_score.
  bool use_own_min_scores = true;
};

}  // namespace graspdb::recognition
