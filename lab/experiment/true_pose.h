// The recognition's scores of the true pose: why it was not the answer.
#pragma once

#include <algorithm>
#include <string>

#include "recognition/recognizer.h"
#include "recognition/verification/confidence.h"

namespace graspdb::lab {

// A pose refined against a segment.
struct PoseScore {
  recognition::Pose refined = recognition::Pose::Identity();  // T_world_object
  recognition::Evidence evidence;
  recognition::ConfidenceFeatures features;
  double confidence = 0;  // 0 to 1
};

struct TruePose {
  std::size_t own_points = 0;      // voxels of the segment that lie on it
  std::size_t segment_points = 0;  // voxels of the segment with most of them; 0: none
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // of its own, world frame, m
  PoseScore whole;                                     // against all of the segment
  double own_score = 0;                                // against its own points alone

  // Of the segment's voxels, 0 to 1.
  double own_share() const {
    return static_cast<double>(own_points) /
           static_cast<double>(std::max<std::size_t>(1, segment_points));
  }
};

// Evidence and confidence features of a pose as text.
std::string TextOf(const recognition::Evidence& evidence,
                   const recognition::ConfidenceFeatures& features);
std::string TextOf(const TruePose& truth);

// Scores `model` at `world_object` (T_world_object) in the segment with most of its points. O(n)
// look-ups for n points of the scan. Thread-safe.
TruePose ScoreTruth(const recognition::Scan& scan, const recognition::Segmentation& segmentation,
                    const recognition::SurfaceModel& model, const recognition::Pose& world_object,
                    const recognition::RecognitionParameters& parameters);

}  // namespace graspdb::lab
