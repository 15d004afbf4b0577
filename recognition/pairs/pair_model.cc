#include "recognition/pairs/pair_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "recognition/points/thinned.h"

namespace graspdb::recognition {
namespace {

// A feature that more than one of so many pairs has, and at least kMinCrowded, says little about
// the pose.
constexpr std::size_t kPairsPerCrowded = 200;
constexpr std::size_t kMinCrowded = 150;
// Distance of the cameras of the stored aspects, m, from the surface.
constexpr float kUsualDistanceM = 0.8F;

// Evenly spread directions (Fibonacci's spiral).
std::vector<Eigen::Vector3f> Directions(int count) {
  std::vector<Eigen::Vector3f> out;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    out.push_back(Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), z).cast<float>());
  }
  return out;
}

}  // namespace

const ModelAspect& PairModel::AspectFrom(const Eigen::Vector3f& towards_camera) const {
  return *std::ranges::max_element(aspects, {}, [&](const ModelAspect& aspect) {
    return aspect.towards_camera.dot(towards_camera);
  });
}

std::size_t PairModel::bytes() const {
  std::size_t out = sizeof(*this) + table->bytes() + frames.size() * sizeof(frames[0]) +
                    2 * sizeof(Eigen::Vector3f) * (points.points.size() + surface.points.size());
  for (const ModelAspect& aspect : aspects) {
    out += aspect.visible.size() * sizeof(aspect.visible[0]) +
           2 * sizeof(Eigen::Vector3f) * aspect.outline.size();
  }
  return out;
}

std::shared_ptr<const PairModel> MakePairModel(const OrientedCloud& surface,
                                               const PairModelParameters& parameters) {
  if (surface.points.empty()) return nullptr;
  auto out = std::make_shared<PairModel>();
  static_cast<ImageModel&>(*out) = MakeImageModel(surface, parameters.surface);
  out->step_m = std::max(parameters.min_step_m, parameters.step_share * out->diameter_m);
  out->points = ThinnedToAtMost(parameters.max_points, surface, &out->step_m);
  if (out->points.points.size() < parameters.min_points) return nullptr;
  const std::size_t pairs = out->points.points.size() * out->points.points.size();
  out->table = std::make_unique<const PairTable>(out->points, out->diameter_m,
                                                 std::max(kMinCrowded, pairs / kPairsPerCrowded));
  for (std::size_t i = 0; i < out->points.points.size(); ++i) {
    out->frames.emplace_back(out->points.points[i], out->points.normals[i]);
  }
  for (const Eigen::Vector3f& towards : Directions(parameters.direction_count)) {
    const float distance = kUsualDistanceM + out->diameter_m / 2;
    out->aspects.push_back(
        out->AspectSeenFrom(out->center + distance * towards, parameters.max_outline_points));
  }
  return out;
}

}  // namespace graspdb::recognition
