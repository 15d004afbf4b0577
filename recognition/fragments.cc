#include "recognition/fragments.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <utility>

#include "recognition/segmentation/clusters.h"

namespace graspdb::recognition {
namespace {

// Minimum share of a segment's points on the model.
constexpr double kShare = 0.8;
// Minimum gap between the pieces that an object leaves over, m, and in voxels.
constexpr double kPieceGapM = 0.01;
constexpr double kPieceGapVoxels = 3.3;

void Take(const Detection& piece, Detection* whole) {
  const auto of_piece = static_cast<double>(piece.point_count);
  const auto of_whole = static_cast<double>(whole->point_count);
  whole->centroid =
      (of_piece * piece.centroid + of_whole * whole->centroid) / (of_piece + of_whole);
  whole->point_count += piece.point_count;
}

// Of two detections of one object the one with the higher score is the whole.
bool MayBePieceOf(const Detection& piece, const Detection& whole) {
  if (!whole.view || !whole.model) return false;
  if (!piece.view) return true;
  return piece.view->object == whole.view->object && piece.score <= whole.score;
}

}  // namespace

bool LiesOn(const Segment& segment, const Detection& whole, double support_distance_m) {
  const Eigen::Isometry3f object_world = whole.refined_pose.inverse().cast<float>();
  std::size_t near = 0;
  for (const Eigen::Vector3f& p : segment.cloud.points) {
    near += whole.model->DistanceTo(object_world * p) < static_cast<float>(support_distance_m);
  }
  return static_cast<double>(near) >= kShare * static_cast<double>(segment.cloud.points.size());
}

bool LeavesPieces(const AnsweredSegment& answer, double support_distance_m, double voxel_size_m,
                  std::size_t min_count, const IsCancelled& is_cancelled) {
  const Eigen::Isometry3f object_world = answer.detection.refined_pose.inverse().cast<float>();
  const auto reach = static_cast<float>(support_distance_m);
  Points rest;
  std::ranges::copy_if(answer.segment.cloud.points, std::back_inserter(rest),
                       [&](const Eigen::Vector3f& p) {
                         return answer.detection.model->DistanceTo(object_world * p) >= reach;
                       });
  const double gap_m = std::max(kPieceGapM, kPieceGapVoxels * voxel_size_m);
  return rest.size() >= min_count && !FindClusters(rest, gap_m, min_count, is_cancelled).empty();
}

void JoinFragments(double support_distance_m, std::vector<AnsweredSegment>* answers) {
  std::vector<std::size_t> order(answers->size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) {
    const Detection& d = (*answers)[i].detection;
    return d.view ? d.score : -1.0;
  });
  std::vector<bool> is_piece(answers->size(), false);
  for (const std::size_t i : order) {
    const AnsweredSegment& piece = (*answers)[i];
    for (std::size_t j = 0; j < answers->size() && !is_piece[i]; ++j) {
      Detection& whole = (*answers)[j].detection;
      if (i == j || is_piece[j] || !MayBePieceOf(piece.detection, whole) ||
          !LiesOn(piece.segment, whole, support_distance_m)) {
        continue;
      }
      Take(piece.detection, &whole);
      is_piece[i] = true;
    }
  }
  std::vector<AnsweredSegment> kept;
  kept.reserve(answers->size());
  for (std::size_t i = 0; i < answers->size(); ++i) {
    if (!is_piece[i]) kept.push_back(std::move((*answers)[i]));
  }
  *answers = std::move(kept);
}

}  // namespace graspdb::recognition
