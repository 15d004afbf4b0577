#include "client/teaching/turntable/turntable_coverage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/status_macros.h"
#include "client/teaching/upload/view_upload.h"
#include "files/messages/pose_message.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using recognition::Pose;

constexpr double kRadian = std::numbers::pi / 180;
constexpr double kSameAzimuthDeg = 0.5;
constexpr double kSameAxisM = 0.001;
constexpr double kUpright = 0.9999;  // cosine of 0.8 degrees
constexpr double kNeighborDeg = 45;
constexpr int kWidestRing = 72;

absl::Status AnotherTurn(const v1::View& view) {
  const Vector3d at = files::FromMessage(view.object_pose()).translation();
  return absl::FailedPreconditionError(absl::StrFormat(
      "%s was not taught about this axis: its object stands at %.4f,%.4f, %.4f m high; give --axis "
      "%.4f,%.4f if the turntable is there, or teach another stable pose id",
      view.name(), at.x(), at.y(), at.z(), at.x(), at.y()));
}

}  // namespace

Pose OnTurntable(const Eigen::Vector2d& axis, double height_m, double azimuth_deg) {
  Pose pose = Pose::Identity();
  pose.translation() = Vector3d(axis.x(), axis.y(), height_m);
  pose.rotate(Eigen::AngleAxisd(azimuth_deg * kRadian, Vector3d::UnitZ()));
  return pose;
}

bool IsOfTurn(const v1::View& view, const Vector3d& origin) {
  const Pose pose = files::FromMessage(view.object_pose());
  return pose.linear()(2, 2) > kUpright && (pose.translation() - origin).norm() < kSameAxisM;
}

absl::StatusOr<TurntableCoverage> TurntableCoverage::Create(double step_deg) {
  RETURN_IF_ERROR(CheckStep(step_deg));
  return TurntableCoverage(step_deg, StepsOf(step_deg));
}

absl::Status TurntableCoverage::Add(const std::vector<v1::View>& views, const Vector3d& origin,
                                    bool clockwise) {
  for (const v1::View& view : views) {
    if (!IsOfTurn(view, origin)) return AnotherTurn(view);
    const Pose pose = files::FromMessage(view.object_pose());
    double azimuth = std::atan2(pose.linear()(1, 0), pose.linear()(0, 0)) / kRadian;
    if (clockwise) azimuth = -azimuth;
    if (azimuth < -kSameAzimuthDeg) azimuth += 360;
    const auto step = static_cast<int>(std::lround(azimuth / step_deg_));
    const bool at_step = step < size_ && std::abs(azimuth - AzimuthDeg(step)) <= kSameAzimuthDeg &&
                         At(step) == nullptr;
    if (at_step) {
      Set(step, {.name = view.name(), .point_count = view.point_count()});
    } else {
      ++others_;
    }
  }
  return absl::OkStatus();
}

const TurnView* TurntableCoverage::At(int step) const {
  const auto found = taught_.find(step);
  return found == taught_.end() ? nullptr : &found->second;
}

std::vector<int> TurntableCoverage::Missing() const {
  std::vector<int> out;
  for (int step = 0; step < size_; ++step) {
    if (At(step) == nullptr) out.push_back(step);
  }
  return out;
}

double TurntableCoverage::NeighborPoints(int step) const {
  double sum = 0;
  int count = 0;
  const int reach = std::min(size_ / 2, static_cast<int>(kNeighborDeg / step_deg_));
  for (const int way : {-1, 1}) {
    for (int i = 1; i <= reach; ++i) {
      const TurnView* view = At((step + way * i + size_) % size_);
      if (view == nullptr) continue;
      sum += view->point_count;
      ++count;
      break;
    }
  }
  return count == 0 ? 0 : sum / count;
}

std::string TurntableCoverage::Ring() const {
  std::string out = absl::StrCat("taught ", taught_.size(), " of ", size_);
  if (others_ > 0) absl::StrAppend(&out, ", and ", others_, " between these steps");
  if (size_ > kWidestRing) return out;
  std::string ring(static_cast<std::size_t>(size_), '.');
  for (const auto& [step, view] : taught_) ring[static_cast<std::size_t>(step)] = '#';
  return absl::StrCat("[", ring, "]  ", out);
}

std::string TurntableCoverage::MissingText() const {
  const std::vector<int> missing = Missing();
  std::vector<std::string> runs;
  for (std::size_t first = 0; first < missing.size();) {
    std::size_t last = first;
    while (last + 1 < missing.size() && missing[last + 1] == missing[last] + 1) ++last;
    const auto name = [&](std::size_t i) { return absl::StrCat(AzimuthDeg(missing[i])); };
    if (last == first) {
      runs.push_back(name(first));
    } else {
      runs.push_back(absl::StrCat(name(first), last == first + 1 ? ", " : " to ", name(last)));
    }
    first = last + 1;
  }
  return runs.empty() ? "" : absl::StrCat(absl::StrJoin(runs, ", "), " degrees");
}

}  // namespace graspdb::client
