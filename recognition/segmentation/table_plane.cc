#include "recognition/segmentation/table_plane.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace graspdb::recognition {
namespace {

// The real tables in docs/adr/0040 are 0.29 m and 21 degrees wide or more; the widest faces in the
// same frames without their table 0.20 m and 18 degrees.
constexpr double kNarrowestTableM = 0.25;
constexpr double kNarrowestTableRad = 0.34;

struct Sampled {
  Eigen::Vector3f point;
  bool is_near = false;  // the plane
};

// Every n-th of the points.
std::vector<Sampled> SampleOf(const Plane& plane, const Points& points, double distance_m) {
  constexpr std::size_t kSamples = 4000;
  const std::size_t step = std::max<std::size_t>(1, points.size() / kSamples);
  std::vector<Sampled> out;
  for (std::size_t i = 0; i < points.size(); i += step) {
    const double height = plane.Height(points[i].cast<double>());
    out.push_back({points[i], std::abs(height) <= distance_m});
  }
  return out;
}

}  // namespace

bool IsSurface(const Plane& plane, const Points& points, double distance_m) {
  constexpr std::size_t kCentres = 200;
  constexpr float kAroundM = 0.03F;
  constexpr double kNearlyAll = 0.8;
  const std::vector<Sampled> sample = SampleOf(plane, points, distance_m);
  std::vector<Sampled> centres;
  std::ranges::copy_if(sample, std::back_inserter(centres), &Sampled::is_near);
  const std::size_t stride = std::max<std::size_t>(1, centres.size() / kCentres);
  int votes = 0;
  for (std::size_t c = 0; c < centres.size(); c += stride) {
    double around = 0;
    double near = 0;
    for (const Sampled& s : sample) {
      if ((s.point - centres[c].point).squaredNorm() > kAroundM * kAroundM) continue;
      around += 1;
      near += s.is_near ? 1 : 0;
    }
    votes += near >= kNearlyAll * around ? 1 : -1;
  }
  return votes > 0;
}

bool IsWideEnough(const Plane& plane, const Points& points, double distance_m) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  double count = 0;
  for (const Sampled& s : SampleOf(plane, points, distance_m)) {
    if (!s.is_near) continue;
    const Eigen::Vector3d p = s.point.cast<double>();
    sum += p;
    products += p * p.transpose();
    ++count;
  }
  if (count < 3) return false;
  const Eigen::Vector3d mean = sum / count;
  const Eigen::Matrix3d covariance = products / count - mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  // The sides of a rectangle with these second moments.
  const double narrow_m = std::sqrt(12 * std::max(0.0, solver.eigenvalues()[1]));
  return narrow_m >= kNarrowestTableM || narrow_m >= kNarrowestTableRad * mean.norm();
}

}  // namespace graspdb::recognition
