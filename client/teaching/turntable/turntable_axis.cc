#include "client/teaching/turntable/turntable_axis.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "absl/status/status.h"
#include "base/status_macros.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "recognition/points/nearest_grid.h"
#include "recognition/points/normals.h"

namespace graspdb::client {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3f;
using recognition::Pose;

constexpr double kWidestTurn = 65 * std::numbers::pi / 180;
constexpr int kAlignmentRounds = 25;
constexpr double kFirstReachM = 0.02;
constexpr double kLastReachM = 0.004;
constexpr double kReachFactor = 0.8;
constexpr float kTurntableCellM = 0.002F;
constexpr float kSameSide = 0.7F;  // cosine of 45 degrees
constexpr int kMinPairs = 4;
constexpr double kLargestDeviationM = 0.001;
// The errors of neighbouring points are correlated: a point counts as this share of one.
constexpr double kIndependent = 0.02;
constexpr double kNormalRadiusM = 0.008;

struct Pair {
  std::size_t from = 0;
  std::size_t to = 0;
  double turn_rad = 0;
};

std::vector<Pair> PairsOf(std::span<const TurnedCloud> views) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t j = 0; j < views.size(); ++j) {
      const double turn =
          std::remainder(views[j].azimuth_rad - views[i].azimuth_rad, 2 * std::numbers::pi);
      if (i != j && std::abs(turn) < kWidestTurn) pairs.push_back({i, j, turn});
    }
  }
  return pairs;
}

// Normal equations of the step of the axis.
struct Equations {
  Matrix2d h = Matrix2d::Zero();
  Vector2d g = Vector2d::Zero();
  double squares = 0;
  double matched = 0;
  double all = 0;
};

// Adds the points of one view, turned onto the other: q = R p + (I - R) axis.
void AddPair(const Pair& pair, std::span<const TurnedCloud> views,
             const recognition::NearestGrid& grid, const Vector2d& axis, double reach_m,
             Equations* out) {
  const Matrix2d turn = Eigen::Rotation2Dd(pair.turn_rad).toRotationMatrix();
  const Matrix2d moves = Matrix2d::Identity() - turn;
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.linear().topLeftCorner<2, 2>() = turn.cast<float>();
  pose.translation().head<2>() = (moves * axis).cast<float>();
  const recognition::OrientedCloud& from = views[pair.from].cloud;
  const recognition::OrientedCloud& to = views[pair.to].cloud;
  for (std::size_t i = 0; i < from.points.size(); ++i) {
    out->all += 1;
    const Vector3f q = pose * from.points[i];
    const int nearest = grid.Nearest(q);
    if (nearest < 0) continue;
    const auto at = static_cast<std::size_t>(nearest);
    const Vector3f& n = to.normals[at];
    const Vector3f off = q - to.points[at];
    if (off.norm() > reach_m || (pose.linear() * from.normals[i]).dot(n) < kSameSide) continue;
    const auto residual = static_cast<double>(n.dot(off));
    const Vector2d slope = moves.transpose() * n.head<2>().cast<double>();
    out->h += slope * slope.transpose();
    out->g += slope * residual;
    out->squares += residual * residual;
    out->matched += 1;
  }
}

absl::Status Undetermined() {
  return absl::FailedPreconditionError(
      "these views do not determine the axis of the turntable; teach more steps of the turn, or "
      "measure the axis");
}

}  // namespace

absl::StatusOr<SeenAxis> FindAxis(std::span<const TurnedCloud> views, const Vector2d& start) {
  const std::vector<Pair> pairs = PairsOf(views);
  if (pairs.size() < kMinPairs) return Undetermined();
  std::vector<recognition::NearestGrid> grids;
  grids.reserve(views.size());
  for (const TurnedCloud& view : views) {
    grids.emplace_back(view.cloud.points, kTurntableCellM, static_cast<float>(kFirstReachM));
  }
  SeenAxis out{.axis = start};
  double reach = kFirstReachM;
  Equations sum;
  double smallest = 0;
  for (int round = 0; round < kAlignmentRounds; ++round) {
    sum = {};
    for (const Pair& pair : pairs) AddPair(pair, views, grids[pair.to], out.axis, reach, &sum);
    smallest = Eigen::SelfAdjointEigenSolver<Matrix2d>(sum.h).eigenvalues().x();
    if (!(smallest > 0)) return Undetermined();
    out.axis -= sum.h.ldlt().solve(sum.g);
    reach = std::max(kLastReachM, kReachFactor * reach);
  }
  out.rms_m = std::sqrt(sum.squares / sum.matched);
  out.share = sum.matched / sum.all;
  out.deviation_m = out.rms_m / std::sqrt(kIndependent * smallest);
  if (out.deviation_m > kLargestDeviationM) return Undetermined();
  return out;
}

absl::StatusOr<std::vector<TurnedCloud>> TaughtTurn(Client& client,
                                                    const std::string& stable_pose) {
  ASSIGN_OR_RETURN(const auto views, client.ListViews(stable_pose));
  std::vector<TurnedCloud> out;
  out.reserve(views.size());
  for (const v1::View& listed : views) {
    ASSIGN_OR_RETURN(const v1::View view, client.GetView(listed.name()));
    ASSIGN_OR_RETURN(const recognition::Points points, files::PointsFromMessage(view.cloud()));
    const Eigen::Isometry3f sensor = files::FromMessage(view.sensor_pose()).cast<float>();
    TurnedCloud turned;
    const Pose object = files::FromMessage(view.object_pose());
    turned.azimuth_rad = std::atan2(object.linear()(1, 0), object.linear()(0, 0));
    turned.cloud.points = points;
    turned.cloud.normals =
        recognition::EstimateNormals(points, Eigen::Vector3d::Zero(), kNormalRadiusM);
    for (Vector3f& p : turned.cloud.points) p = sensor * p;
    for (Vector3f& n : turned.cloud.normals) n = sensor.linear() * n;
    out.push_back(std::move(turned));
  }
  return out;
}

}  // namespace graspdb::client
