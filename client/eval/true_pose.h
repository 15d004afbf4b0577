// What the recognition thinks of a pose that is known to be right: why it was not the answer.
#pragma once

#include <memory>
#include <optional>

#include "recognition/confidence.h"
#include "recognition/recognizer.h"

namespace graspdb::client {

// Where it was lost, in the order of the recognition's steps.
enum class LostBy {
  kSegmentation,  // no segment is mostly on it: it went with the table, or with its neighbours
  kSearch,        // at its place it would have explained more than the answer that was found
  kRanking,       // something else explains the segment better
  kConfidence,    // it was found, or would be, and is not believed
};

struct TruePose {
  std::size_t own_points = 0;      // voxels of the segment that lie on it
  std::size_t segment_points = 0;  // voxels of the segment that most of its own are in; 0: none
  double own_share = 0;            // of the segment's
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // of its own, world frame, m
  // Refined from the truth against that segment, T_world_object, and what speaks for it there.
  recognition::Pose refined = recognition::Pose::Identity();
  recognition::Evidence evidence;
  recognition::Doubt doubt;
  double score = 0;
  double own_score = 0;  // the same against its own points alone
};

// Puts `model` at `world_object` into the segmented scan. Thread-safe.
TruePose ScoreTruth(const recognition::Scan& scan, const recognition::Segmentation& segmentation,
                    const recognition::SurfaceModel& model, const recognition::Pose& world_object,
                    const recognition::RecognitionParameters& parameters);

}  // namespace graspdb::client
