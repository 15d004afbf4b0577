#include "recognition/index/root_projection.h"

#include <Eigen/Eigenvalues>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace graspdb::recognition {
namespace {

// Of the variance; views of real parts keep 0.85 to 0.9, independent bins 0.15. Between the two a
// smaller share leaves more views to be measured, from 0.5 on more than bytes of all bins do.
constexpr double kMinKept = 0.7;
constexpr auto kAxes = static_cast<Eigen::Index>(RootProjection::kComponents);

// Orthonormal; every entry has the same size.
Eigen::MatrixXd Hadamard() {
  Eigen::MatrixXd out(kAxes, kAxes);
  for (Eigen::Index row = 0; row < kAxes; ++row) {
    for (Eigen::Index column = 0; column < kAxes; ++column) {
      const bool is_odd = std::popcount(static_cast<std::size_t>(row & column)) % 2 == 1;
      out(row, column) = is_odd ? -1 : 1;
    }
  }
  return out / std::sqrt(static_cast<double>(kAxes));
}

}  // namespace

std::shared_ptr<const RootProjection> RootProjection::Fit(
    const std::vector<std::vector<float>>& sample) {
  if (sample.size() < kComponents || sample.front().size() < kComponents) return nullptr;
  const auto bins = static_cast<Eigen::Index>(sample.front().size());
  Eigen::MatrixXf rows(bins, static_cast<Eigen::Index>(sample.size()));
  for (std::size_t i = 0; i < sample.size(); ++i) {
    rows.col(static_cast<Eigen::Index>(i)) =
        Eigen::Map<const Eigen::VectorXf>(sample[i].data(), bins);
  }
  if (!rows.allFinite()) return nullptr;
  const Eigen::VectorXf mean = rows.rowwise().mean();
  rows.colwise() -= mean;
  const Eigen::MatrixXd covariance = (rows * rows.transpose()).cast<double>();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  const double kept = solver.eigenvalues().tail(kAxes).sum();
  if (solver.info() != Eigen::Success || !(kept > kMinKept * solver.eigenvalues().sum())) {
    return nullptr;
  }
  const Eigen::MatrixXf axes =
      (Hadamard() * solver.eigenvectors().rightCols(kAxes).transpose()).cast<float>();
  const auto floats = [](const auto& matrix) {
    return std::span(matrix.data(), static_cast<std::size_t>(matrix.size()));
  };
  return std::shared_ptr<const RootProjection>(new RootProjection(floats(mean), floats(axes)));
}

RootProjection::Projection RootProjection::Project(std::span<const float> roots) const {
  Projection out{std::vector<float>(kComponents, 0.0F)};
  double squares = 0;
  double length = 0;
  for (std::size_t bin = 0; bin < means_.size(); ++bin) {
    const float off = roots[bin] - means_[bin];
    squares += static_cast<double>(off) * off;
    length += static_cast<double>(roots[bin]) * roots[bin];
    const float* axis = axes_.data() + bin * kComponents;
    for (std::size_t i = 0; i < kComponents; ++i) out.components[i] += axis[i] * off;
  }
  // A sum of n products is off by at most n + 4 half units in the last place (the difference, the
  // axis, the product, the sum) times the product of the lengths; and the roots were rounded.
  // 5e-5 for 288 bins of mass 1, where distances of neighbours are about 0.15.
  const double unit = std::numeric_limits<float>::epsilon();
  const double sums = std::sqrt(static_cast<double>(kComponents));
  out.rounding = static_cast<float>(
      unit *
      (static_cast<double>(means_.size() + 4) * sums * std::sqrt(squares) + std::sqrt(length)));
  return out;
}

}  // namespace graspdb::recognition
