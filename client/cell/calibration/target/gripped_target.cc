#include "client/cell/calibration/target/gripped_target.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <numbers>

#include "recognition/points/voxels.h"
#include "recognition/verification/visibility.h"
#include "rendering/meshes/mesh.h"

namespace graspdb::client {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;
using recognition::OrientedCloud;
using recognition::Pose;
using recognition::SurfaceModel;

// Directions on a whole sphere: neighbours are eleven degrees apart.
constexpr int kCameraDirections = 300;
// Sine of the lowest look-down angle: gripped objects are seen slightly from below.
constexpr double kLowestSine = -0.2;
// Far enough to see the whole side, m.
constexpr float kCameraDistanceM = 0.7F;
constexpr std::size_t kPoints = 60;
// A prime above kPoints, so that no point of a side is taken twice; of 60 points every 37th.
constexpr std::size_t kPointStep = 877;
constexpr std::size_t kAnchors = 4;

// Indices by farthest point sampling, the first nearest to the mean.
std::vector<std::size_t> FarApart(const recognition::Points& points) {
  Vector3f mean = Vector3f::Zero();
  for (const Vector3f& p : points) mean += p;
  mean /= static_cast<float>(points.size());
  std::vector<std::size_t> out;
  std::vector<float> nearest(points.size(), 1e9F);
  const auto by_distance = [&](const Vector3f& a, const Vector3f& b) {
    return (a - mean).squaredNorm() < (b - mean).squaredNorm();
  };
  auto next =
      static_cast<std::size_t>(std::ranges::min_element(points, by_distance) - points.begin());
  while (out.size() < std::min(kAnchors, points.size())) {
    out.push_back(next);
    for (std::size_t i = 0; i < points.size(); ++i) {
      nearest[i] = std::min(nearest[i], (points[i] - points[next]).squaredNorm());
    }
    next = static_cast<std::size_t>(std::ranges::max_element(nearest) - nearest.begin());
  }
  return out;
}

// Places of the scan at which sides are tried.
constexpr double kPlaceSpacingM = 0.012;
constexpr std::size_t kMaxPlaces = 500;
constexpr int kRollTurns = 30;
// Minimum cosine between normals of scan and model: at the place; at all other points.
constexpr float kPlaceAgreement = 0.9F;
constexpr float kAgreement = 0.6F;
// Maximum distance of a side's point from the scan, m.
constexpr float kOnScanM = 0.012F;
// This many points, spread over the side, reject most wrong guesses early.
constexpr std::size_t kEarlyPoints = 16;
constexpr float kMinEarlyFit = 0.25F;
// Guesses to refine: per place, because many poses fit on e.g. a round arm, and in total.
constexpr std::size_t kGuessesEach = 8;
constexpr std::size_t kMaxGuesses = 2000;
constexpr std::size_t kGrippedFinalists = 24;
// Guesses closer than this count as the same pose: m, rad.
constexpr double kSameGuessM = 0.008;
constexpr double kSameGuessRad = 0.14;
// Minimum confirmed share of the visible surface, and minimum visible share: an empty gripper
// matches many objects to nine tenths.
constexpr double kMinSeen = 0.94;
constexpr double kMinShown = 0.55;

struct Guess {
  Matrix3f rotation = Matrix3f::Identity();  // T_sensor_target
  Vector3f translation = Vector3f::Zero();
  float fit = 0;

  TargetFit Start() const {
    TargetFit out;
    out.world_target.linear() =
        Eigen::Quaterniond(rotation.cast<double>()).normalized().toRotationMatrix();
    out.world_target.translation() = translation.cast<double>();
    return out;
  }
};

void KeepBest(std::size_t count, std::vector<Guess>* guesses) {
  std::ranges::stable_sort(*guesses, std::greater(), &Guess::fit);
  guesses->resize(std::min(guesses->size(), count));
}

// Matches the sides of a model against a scan.
class SideMatcher {
 public:
  SideMatcher(const SurfaceModel& model, const OrientedCloud& cloud)
      : sides_(SidesOf(model)), cloud_(cloud), grid_(GridOf(cloud.points)) {}

  std::vector<Guess> Guesses() const {
    std::vector<Guess> out;
    for (const std::size_t place : Places()) {
      std::vector<Guess> here;
      for (int turn = 0; turn < kRollTurns; ++turn) TryAt(place, turn, &here);
      KeepBest(kGuessesEach, &here);
      out.insert(out.end(), here.begin(), here.end());
    }
    KeepBest(kMaxGuesses, &out);
    return out;
  }

 private:
  std::vector<std::size_t> Places() const {
    const recognition::VoxelCloud thin =
        recognition::DownsampleToVoxels(cloud_.points, kPlaceSpacingM);
    std::vector<std::size_t> all(thin.points.size());
    for (std::size_t i = 0; i < thin.voxel_of.size(); ++i) {
      all[static_cast<std::size_t>(thin.voxel_of[i])] = i;
    }
    const std::size_t step = 1 + all.size() / kMaxPlaces;
    std::vector<std::size_t> out;
    out.reserve(all.size() / step + 1);
    for (std::size_t i = 0; i < all.size(); i += step) out.push_back(all[i]);
    return out;
  }

  void TryAt(std::size_t place, int turn, std::vector<Guess>* guesses) const {
    const Vector3f& at = cloud_.points[place];
    const auto angle = static_cast<float>(2 * std::numbers::pi * turn / kRollTurns);
    const Matrix3f sensor_look = (Eigen::Quaternionf::FromTwoVectors(Vector3f::UnitZ(), at) *
                                  Eigen::AngleAxisf(angle, Vector3f::UnitZ()))
                                     .toRotationMatrix();
    for (const Side& side : sides_) {
      Guess guess{.rotation = sensor_look * side.look_object};
      const Vector3f wanted = guess.rotation.transpose() * cloud_.normals[place];
      for (const std::size_t anchor : side.anchors) {
        if (wanted.dot(side.normals[anchor]) < kPlaceAgreement) continue;
        guess.translation = at - guess.rotation * side.points[anchor];
        guess.fit = FitOf(side, guess);
        if (guess.fit > 0) guesses->push_back(guess);
      }
    }
  }

  // Share of the side that lies on the scan, 0 to 1.
  float FitOf(const Side& side, const Guess& guess) const {
    float sum = 0;
    for (std::size_t i = 0; i < side.points.size(); ++i) {
      if (i == kEarlyPoints && sum < kMinEarlyFit * static_cast<float>(kEarlyPoints)) return 0;
      const Vector3f p = guess.rotation * side.points[i] + guess.translation;
      const int nearest = grid_.Nearest(p);
      if (nearest < 0) continue;
      const auto at = static_cast<std::size_t>(nearest);
      if ((guess.rotation * side.normals[i]).dot(cloud_.normals[at]) < kAgreement) continue;
      const float share = (p - cloud_.points[at]).squaredNorm() / (kOnScanM * kOnScanM);
      sum += std::max(0.0F, 1 - share);
    }
    return sum / static_cast<float>(side.points.size());
  }

  const std::vector<Side> sides_;
  const OrientedCloud& cloud_;
  const recognition::NearestGrid grid_;
};

bool AreSamePose(const SurfaceModel& model, const Pose& a, const Pose& b) {
  const Eigen::Vector3d center = model.center.cast<double>();
  return (a * center - b * center).norm() < kSameGuessM &&
         Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() < kSameGuessRad;
}

// The best guesses, without duplicates.
std::vector<TargetFit> Finalists(const SurfaceModel& model, const TargetScan& scan) {
  std::vector<TargetFit> all;
  for (const Guess& guess : SideMatcher(model, scan.cloud()).Guesses()) {
    all.push_back(guess.Start());
  }
  scan.RefineRoughly(model, all.data(), all.size());
  std::ranges::stable_sort(all, std::greater(), &TargetFit::value);
  std::vector<TargetFit> out;
  for (const TargetFit& fit : all) {
    const auto is_same = [&](const TargetFit& other) {
      return AreSamePose(model, other.world_target, fit.world_target);
    };
    if (std::ranges::none_of(out, is_same)) out.push_back(fit);
    if (out.size() == kGrippedFinalists) break;
  }
  return out;
}

// Enough of the target is visible, and enough of that is confirmed.
bool IsFound(const TargetFit& fit) {
  return fit.value() > 0 && fit.seen >= kMinSeen && fit.shown >= kMinShown;
}

}  // namespace

std::vector<Side> SidesOf(const recognition::SurfaceModel& model) {
  std::vector<Side> out;
  for (int k = 0; k < kCameraDirections; ++k) {
    const Vector3f to_camera = rendering::EvenDirection(k, kCameraDirections);
    if (static_cast<double>(to_camera.z()) < kLowestSine) continue;
    Side side;
    side.look_object =
        Eigen::Quaternionf::FromTwoVectors(to_camera, -Vector3f::UnitZ()).toRotationMatrix();
    Eigen::Isometry3f sensor_object = Eigen::Isometry3f::Identity();
    sensor_object.linear() = side.look_object;
    sensor_object.translation() =
        Vector3f(0, 0, kCameraDistanceM) - side.look_object * model.center;
    const recognition::VisibleSurface visible(model.coarse, sensor_object);
    const std::vector<std::size_t>& seen = visible.points();
    if (seen.empty()) continue;
    const std::size_t count = std::min(kPoints, seen.size());
    for (std::size_t i = 0; i < count; ++i) {
      // Every prefix is spread over all of them.
      const std::size_t at = seen[(i * kPointStep % count) * seen.size() / count];
      side.points.push_back(model.coarse.cloud.points[at]);
      side.normals.push_back(model.coarse.cloud.normals[at]);
    }
    side.anchors = FarApart(side.points);
    out.push_back(std::move(side));
  }
  return out;
}

std::optional<TargetFit> FindGrippedTarget(const SurfaceModel& model, const TargetScan& scan) {
  TargetFit best;
  for (const TargetFit& finalist : Finalists(model, scan)) {
    const TargetFit fit = scan.Refine(model, finalist.world_target);
    if (fit.value() > best.value()) best = fit;
  }
  if (!IsFound(best)) return std::nullopt;
  return best;
}

}  // namespace graspdb::client
