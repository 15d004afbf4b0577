#include "recognition/descriptors/gsh288.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "recognition/base/round_down.h"
#include "recognition/descriptors/heading.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;

constexpr int kAzimuths = 16;
constexpr int kElevations = 6;
constexpr int kColumns = 12;
constexpr int kRows = 8;
// Positions farther from the centroid count at the rim, m.
constexpr double kHalfWidthM = 0.12;
constexpr double kHalfHeightM = 0.06;

// A histogram over a rectangle; a count goes to the four bins around it, by distance.
class Histogram2d {
 public:
  // With `wraps` the first column follows the last one.
  Histogram2d(int columns, int rows, bool wraps)
      : columns_(columns),
        rows_(rows),
        wraps_(wraps),
        counts_(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows)) {}

  // `u` and `v` from 0 to 1; what lies outside counts at the rim.
  void Add(double u, double v) {
    const double x = u * columns_ - 0.5;
    const double y = v * rows_ - 0.5;
    const auto column = static_cast<int>(RoundDown(x));
    const auto row = static_cast<int>(RoundDown(y));
    for (const int dy : {0, 1}) {
      for (const int dx : {0, 1}) {
        const double share = std::abs(1 - dx - (x - column)) * std::abs(1 - dy - (y - row));
        At(column + dx, row + dy) += share;
      }
    }
    total_ += 1;
  }

  void Append(double mass, Descriptor* out) const {
    for (const double count : counts_) out->push_back(static_cast<float>(count * mass / total_));
  }

 private:
  // At most one column outside.
  double& At(int column, int row) {
    if (wraps_ && column < 0) column += columns_;
    if (wraps_ && column >= columns_) column -= columns_;
    column = std::clamp(column, 0, columns_ - 1);
    row = std::clamp(row, 0, rows_ - 1);
    return counts_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                   static_cast<std::size_t>(column)];
  }

  int columns_;
  int rows_;
  bool wraps_;
  std::vector<double> counts_;
  double total_ = 0;
};

// From 0 to 1 over [-half, half]; clamped, so that a bin's number stays small.
double Share(double value, double half) {
  return std::clamp((value + half) / (2 * half), 0.0, 1.0);
}

}  // namespace

Descriptor DescribeGsh288(const OrientedCloud& cloud, const Pose& sensor) {
  Vector3d centroid = Vector3d::Zero();
  for (const auto& p : cloud.points) centroid += p.cast<double>();
  centroid /= static_cast<double>(cloud.points.size());
  const Vector3d ahead = SideSeen(sensor, centroid);
  const Vector3d aside = Vector3d::UnitZ().cross(ahead);

  Histogram2d normals(kAzimuths, kElevations, /*wraps=*/true);
  Histogram2d front(kColumns, kRows, /*wraps=*/false);
  Histogram2d side(kColumns, kRows, /*wraps=*/false);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Vector3d n = cloud.normals[i].cast<double>();
    const double azimuth = std::atan2(n.dot(aside), n.dot(ahead));
    normals.Add(Share(azimuth, std::numbers::pi), Share(n.z(), 1));
    const Vector3d d = cloud.points[i].cast<double>() - centroid;
    front.Add(Share(d.dot(aside), kHalfWidthM), Share(d.z(), kHalfHeightM));
    side.Add(Share(d.dot(ahead), kHalfWidthM), Share(d.z(), kHalfHeightM));
  }
  Descriptor out;
  out.reserve(kAzimuths * kElevations + 2 * kColumns * kRows);
  for (const Histogram2d* part : {&normals, &front, &side}) part->Append(1.0 / 3, &out);
  return out;
}

}  // namespace graspdb::recognition
