#include "recognition/matching/registration.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// All are chosen, for the single-view baseline; none is measured alone.
//
// A smaller step is the last one. Doubled, the alignment ends as early or earlier.
constexpr double kNegligibleTurn = 1e-5;   // rad
constexpr double kNegligibleShift = 1e-6;  // m
// One for each of a pose's parameters. Doubled, alignments with 6 to 11 end at the pose so far.
constexpr std::size_t kMinCorrespondences = 6;
// Reach of the next correspondences as a multiple of the median distance: parts without a
// counterpart are far away and must not extend their own reach. Doubled, such parts take part in
// the alignment up to twice as far away.
constexpr double kTrim = 4.0;
// ... but never less than this, m: neighbouring voxels are 3 mm apart. Doubled, points up to 12 mm
// away are inliers, so that fewer alignments are rejected.
constexpr double kSmallestReach = 0.006;

struct Correspondence {
  Vector3d source;  // moved
  Vector3d target;
  Vector3d normal;  // of the target
};

std::vector<Correspondence> Correspond(const Points& source, const RegistrationTarget& target,
                                       const Pose& pose, double reach) {
  std::vector<Correspondence> out;
  out.reserve(source.size());
  for (const auto& p : source) {
    const Vector3d moved = pose * p.cast<double>();
    const Neighbor n = target.search.Nearest(moved.cast<float>());
    if (n.index < 0 || n.squared_distance > reach * reach) continue;
    const auto i = static_cast<std::size_t>(n.index);
    out.push_back(
        {moved, target.cloud.points[i].cast<double>(), target.cloud.normals[i].cast<double>()});
  }
  return out;
}

double RmsDistance(const std::vector<Correspondence>& pairs) {
  double sum = 0;
  for (const Correspondence& c : pairs) sum += (c.source - c.target).squaredNorm();
  return pairs.empty() ? 0 : std::sqrt(sum / static_cast<double>(pairs.size()));
}

double MedianDistance(const std::vector<Correspondence>& pairs) {
  std::vector<double> squared(pairs.size());
  std::ranges::transform(pairs, squared.begin(), [](const Correspondence& c) {
    return (c.source - c.target).squaredNorm();
  });
  const auto middle = squared.begin() + static_cast<std::ptrdiff_t>(squared.size() / 2);
  std::ranges::nth_element(squared, middle);
  return std::sqrt(*middle);
}

// One Gauss-Newton step on the distances to the tangent planes, about the mean of the points.
// Directions that the points do not constrain (a plane's slide, a sphere's turn) are damped.
Pose PointToPlaneStep(const std::vector<Correspondence>& pairs) {
  Vector3d center = Vector3d::Zero();
  for (const Correspondence& c : pairs) center += c.source;
  center /= static_cast<double>(pairs.size());

  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double size = 0;
  for (const Correspondence& c : pairs) {
    const Vector3d arm = c.source - center;
    Vector6d jacobian;
    jacobian << arm.cross(c.normal), c.normal;
    const double residual = c.normal.dot(c.source - c.target);
    hessian.noalias() += jacobian * jacobian.transpose();
    gradient += residual * jacobian;
    size += arm.squaredNorm();
  }
  const double damping = 1e-3;
  hessian.topLeftCorner<3, 3>().diagonal().array() += damping * size;
  hessian.bottomRightCorner<3, 3>().diagonal().array() +=
      damping * static_cast<double>(pairs.size());
  const Vector6d motion = -hessian.ldlt().solve(gradient);

  const Vector3d turn = motion.head<3>();
  Pose step = Pose::Identity();
  if (turn.norm() > 0) step.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).matrix();
  step.translation() = center + motion.tail<3>() - step.linear() * center;
  return step;
}

bool IsNegligible(const Pose& step, const Vector3d& at) {
  const double turn = Eigen::AngleAxisd(step.linear()).angle();
  return std::abs(turn) < kNegligibleTurn && (step * at - at).norm() < kNegligibleShift;
}

}  // namespace

Registration Align(const Points& source, const RegistrationTarget& target, const Pose& initial,
                   const MatchingParameters& parameters) {
  Registration out;
  out.target_source = initial;
  double reach = parameters.max_correspondence_m;
  for (int i = 0; i < parameters.icp_iteration_count && !out.converged; ++i) {
    const auto pairs = Correspond(source, target, out.target_source, reach);
    if (pairs.size() < kMinCorrespondences) break;
    const Pose step = PointToPlaneStep(pairs);
    out.converged = IsNegligible(step, pairs.front().source);
    out.target_source = step * out.target_source;
    out.iterations = i + 1;
    reach = std::clamp(kTrim * MedianDistance(pairs), kSmallestReach, reach);
  }
  // Rounding in many products must not skew the rotation.
  out.target_source.linear() =
      Eigen::Quaterniond(out.target_source.linear()).normalized().toRotationMatrix();
  const auto pairs = Correspond(source, target, out.target_source, kSmallestReach);
  out.rms_error_m = RmsDistance(pairs);
  if (!source.empty()) {
    out.inlier_fraction = static_cast<double>(pairs.size()) / static_cast<double>(source.size());
  }
  return out;
}

double Support(const Points& a, const PointSearch& b, double support_m) {
  if (a.empty()) return 0;
  double sum = 0;
  for (const auto& p : a) {
    const double squared = b.Nearest(p).squared_distance;
    sum += std::max(0.0, 1 - squared / (support_m * support_m));
  }
  return sum / static_cast<double>(a.size());
}

}  // namespace graspdb::recognition
