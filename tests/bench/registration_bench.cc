// Laying what was taught on what is seen: from 7.5 degrees and some millimetres off.
#include <benchmark/benchmark.h>

#include "recognition/registration.h"
#include "tests/bench/frames.h"
#include "tests/bench/peer_pcl.h"
#include "tests/bench/suite.h"

namespace graspdb::bench {
namespace {

using recognition::MatchingParameters;
using recognition::OrientedCloud;
using recognition::Pose;

// A scan, and the same thing seen from a few degrees aside, both in the world frame; `guess`
// is where the search begins.
struct Pair {
  OrientedCloud scan;
  OrientedCloud view;
  Pose guess = Pose::Identity();
};

Pair PairOf(const std::string& frame_name) {
  const Frame& frame = SimulatedFrame(frame_name);
  recognition::StageLog log;
  const auto found = recognition::SegmentScan(
      ScanOf(frame), {}, {}, [] { return false; }, &log);
  Pair out;
  out.scan = found->segments.front().cloud;
  out.view = out.scan;
  const Eigen::Vector3d center = found->segments.front().centroid;
  out.guess.translate(center + Eigen::Vector3d(0.004, -0.003, 0.002));
  out.guess.rotate(Eigen::AngleAxisd(0.13, Eigen::Vector3d::UnitZ()));
  out.guess.translate(-center);
  return out;
}

double Residual(const OrientedCloud& scan, const recognition::PointSearch& search,
                const Pose& view_scan) {
  double squares = 0;
  for (const auto& p : scan.points) {
    squares += static_cast<double>(
        search.Nearest((view_scan * p.cast<double>()).cast<float>()).squared_distance);
  }
  return std::sqrt(squares / static_cast<double>(scan.points.size()));
}

void Add(const std::string& frame) {
  const auto pair = std::make_shared<const Pair>(PairOf(frame));
  const auto search = std::make_shared<const recognition::PointSearch>(pair->view.points);
  const std::string work =
      "one registration, " + std::to_string(pair->scan.points.size()) + " points";
  const auto report = [=](benchmark::State& state, const Pose& found) {
    state.counters["residual_mm"] = 1000 * Residual(pair->scan, *search, found);
    state.counters["points"] = static_cast<double>(pair->scan.points.size());
  };
  Compare(work, "graspdb", [=](benchmark::State& state) {
    Pose found = Pose::Identity();
    for (auto _ : state) {
      found = recognition::Align(pair->scan.points, {pair->view, *search}, pair->guess, {})
                  .target_source;
    }
    report(state, found);
  });
  const MatchingParameters parameters;
  const auto scan = peer::ToPcl(pair->scan.points);
  const auto view = peer::ToPcl(pair->view.points);
  const Eigen::Matrix4f guess = pair->guess.cast<float>().matrix();
  Compare(work, "PCL ICP", [=](benchmark::State& state) {
    peer::Alignment found;
    for (auto _ : state) {
      found = peer::Align(scan, view, guess, parameters.max_correspondence_m);
    }
    report(state, Pose(found.target_source.cast<double>()));
  });
  const auto oriented_scan = peer::ToPcl(pair->scan);
  const auto oriented_view = peer::ToPcl(pair->view);
  Compare(work, "PCL ICP with normals", [=](benchmark::State& state) {
    peer::Alignment found;
    for (auto _ : state) {
      found = peer::AlignWithNormals(oriented_scan, oriented_view, guess,
                                     parameters.max_correspondence_m);
    }
    report(state, Pose(found.target_source.cast<double>()));
  });
}

}  // namespace

void AddRegistration() {
  for (const char* frame : {"kinect-v2-one", "kinect-v1-one"}) Add(frame);
}

}  // namespace graspdb::bench
