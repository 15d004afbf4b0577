// From a frame to a verified pose and a grasp, among 10,000 views.
#include <benchmark/benchmark.h>
#include <pcl/common/centroid.h>

#include "recognition/recognizer.h"
#include "tests/bench/catalogue.h"
#include "tests/bench/frames.h"
#include "tests/bench/peer_pcl.h"
#include "tests/bench/suite.h"

namespace graspdb::bench {
namespace {

constexpr std::size_t kViews = 10'000;
constexpr int kCandidates = 10;

// What the peer keeps of the catalogue.
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

void Ours(benchmark::State& state, const Frame& frame, Catalogue& catalogue) {
  double grasps = 0;
  recognition::RecognitionParameters parameters;
  parameters.matching.verified_view_count = kCandidates;
  for (auto _ : state) {
    const auto answer = recognition::Recognize(ScanOf(frame), catalogue.snapshot(), catalogue,
                                               parameters, [] { return false; });
    grasps = 0;
    if (!answer.ok()) continue;
    for (const auto& detection : answer->detections) grasps += !detection.grasps.empty();
  }
  state.counters["grasps"] = grasps;
}

void Peer(benchmark::State& state, const Frame& frame, const PeerCatalogue& catalogue) {
  const recognition::MatchingParameters parameters;
  double grasps = 0;
  for (auto _ : state) {
    grasps = 0;
    const auto cloud = peer::Unproject(frame.depth, frame.camera, kDepthUnitM);
    for (const auto& thing : peer::Describe(cloud, frame.world_sensor, frame.region, {}, {})) {
      const peer::Answer answer = peer::Recognize(thing, *catalogue.forest, catalogue.views,
                                                  kCandidates, parameters.max_correspondence_m);
      grasps += answer.view >= 0;
    }
  }
  state.counters["grasps"] = grasps;
}

}  // namespace

void AddWhole() {
  // What the recognition loads it may keep.
  const Lazy<std::shared_ptr<Catalogue>> catalogue(
      [] { return std::make_shared<Catalogue>(kViews); });
  const Lazy<PeerCatalogue> peer([=] { return PeerOf(**catalogue); });
  for (const char* name : {"kinect-v2-one", "kinect-v1-one", "kinect-v2-five"}) {
    const std::string work = std::string("frame to grasp, 10000 views, ") + name;
    Compare(work, "graspdb",
            [=](benchmark::State& state) { Ours(state, SimulatedFrame(name), **catalogue); });
    Compare(work, "PCL",
            [=](benchmark::State& state) { Peer(state, SimulatedFrame(name), *peer); });
  }
}

}  // namespace graspdb::bench
