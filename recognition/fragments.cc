#include "recognition/fragments.h"

#include <cstddef>
#include <utility>

namespace graspdb::recognition {
namespace {

// Of a segment's points, so many must lie on the model.
constexpr double kShare = 0.8;

bool LiesOn(const Segment& segment, const Detection& whole, double support_distance_m) {
  const Eigen::Isometry3f object_world = whole.refined_pose.inverse().cast<float>();
  std::size_t near = 0;
  for (const Eigen::Vector3f& p : segment.cloud.points) {
    near += whole.model->DistanceTo(object_world * p) < static_cast<float>(support_distance_m);
  }
  return static_cast<double>(near) >= kShare * static_cast<double>(segment.cloud.points.size());
}

void Take(const Detection& piece, Detection* whole) {
  const auto of_piece = static_cast<double>(piece.point_count);
  const auto of_whole = static_cast<double>(whole->point_count);
  whole->centroid =
      (of_piece * piece.centroid + of_whole * whole->centroid) / (of_piece + of_whole);
  whole->point_count += piece.point_count;
}

}  // namespace

void JoinFragments(double support_distance_m, std::vector<AnsweredSegment>* answers) {
  std::vector<bool> is_piece(answers->size(), false);
  for (std::size_t i = 0; i < answers->size(); ++i) {
    const AnsweredSegment& piece = (*answers)[i];
    if (piece.detection.view) continue;
    for (AnsweredSegment& other : *answers) {
      Detection& whole = other.detection;
      if (!whole.view || !whole.model || !LiesOn(piece.segment, whole, support_distance_m)) {
        continue;
      }
      Take(piece.detection, &whole);
      is_piece[i] = true;
      break;
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
