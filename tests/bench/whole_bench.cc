// From a frame to a verified pose and a grasp, among 10,000 views.
#include <benchmark/benchmark.h>
#include <pcl/common/centroid.h>

#include <chrono>
#include <functional>

#include "program/base/latency_histogram.h"
#include "recognition/recognizer.h"
#include "tests/bench/catalogue.h"
#include "tests/bench/frames.h"
#include "tests/bench/peer/peer_pcl.h"
#include "tests/bench/suite.h"

namespace graspdb::bench {
namespace {

constexpr std::size_t kViews = 10'000;
constexpr int kCandidates = 10;

using Milliseconds = std::chrono::duration<double, std::milli>;

// The peer's catalogue.
struct PeerCatalogue {
  std::vector<peer::View> views;
  std::unique_ptr<peer::Forest> forest;
};

PeerCatalogue PeerOf(const Catalogue& catalogue) {
  PeerCatalogue out;
  std::vector<peer::Signature> signatures;
  for (const TaughtCloud& taught : catalogue.views()) {
    peer::View view;
    view.cloud = peer::ToPcl(*taught.cloud);
    pcl::compute3DCentroid(*view.cloud, view.centroid);
    view.world_grasp = taught.view->world_object.cast<float>().matrix();
    out.views.push_back(std::move(view));
    signatures.push_back(
        peer::DescribeCloud(*taught.cloud, taught.view->world_sensor.translation()));
  }
  out.forest = std::make_unique<peer::Forest>(signatures);
  return out;
}

// Recognizes frames in turn; `recognize` returns the number of grasps.
void Run(benchmark::State& state, const std::vector<const Frame*>& frames,
         const std::function<int(const Frame&)>& recognize) {
  LatencyHistogram times;
  int grasps = 0;
  // Models are made on first use and kept.
  for (const Frame* frame : frames) benchmark::DoNotOptimize(recognize(*frame));
  for (auto _ : state) {
    grasps = 0;
    for (const Frame* frame : frames) {
      const auto begin = std::chrono::steady_clock::now();
      grasps += recognize(*frame);
      times.Record(std::chrono::steady_clock::now() - begin);
    }
  }
  state.counters["grasps"] = grasps;
  state.counters["p50_ms"] = Milliseconds(times.Percentile(50)).count();
  state.counters["p99_ms"] = Milliseconds(times.Percentile(99)).count();
}

int Ours(const Frame& frame, Catalogue& catalogue) {
  recognition::RecognitionParameters parameters;
  parameters.matching.verified_view_count = kCandidates;
  const auto answer = recognition::Recognize(ScanOf(frame), catalogue.snapshot(), catalogue,
                                             parameters, [] { return false; });
  int grasps = 0;
  if (!answer.ok()) return grasps;
  for (const auto& detection : answer->detections) grasps += !detection.grasps.empty();
  return grasps;
}

int Peer(const Frame& frame, const PeerCatalogue& catalogue) {
  const recognition::MatchingParameters parameters;
  int grasps = 0;
  const auto cloud = peer::Unproject(frame.depth, frame.camera, kDepthUnitM);
  for (const auto& object : peer::Describe(cloud, frame.world_sensor, frame.region, {}, {})) {
    grasps += peer::Recognize(object, *catalogue.forest, catalogue.views, kCandidates,
                              parameters.max_correspondence_m)
                  .view >= 0;
  }
  return grasps;
}

}  // namespace

void AddWhole() {
  // What the recognition loads it may keep.
  const Lazy<std::shared_ptr<Catalogue>> catalogue(
      [] { return std::make_shared<Catalogue>(kViews); });
  const Lazy<PeerCatalogue> peer([=] { return PeerOf(**catalogue); });
  const auto add = [=](const std::string& name, const Frames& frames) {
    const std::string work = "frame to grasp, 10000 views, " + name;
    Compare(work, "graspdb", [=](benchmark::State& state) {
      Catalogue& known = **catalogue;
      Run(state, frames(), [&](const Frame& frame) { return Ours(frame, known); });
    });
    Compare(work, "PCL", [=](benchmark::State& state) {
      const PeerCatalogue& known = *peer;
      Run(state, frames(), [&](const Frame& frame) { return Peer(frame, known); });
    });
  };
  for (const std::string name : {"kinect-v2-one", "kinect-v1-one", "kinect-v2-five"}) {
    add(name, [=] { return std::vector{&SimulatedFrame(name)}; });
  }
  add("each of 13 parts alone, twice", [] { return PointersTo(PartFrames()); });
}

}  // namespace graspdb::bench
