// From a frame to the descriptors of its objects.
#include <benchmark/benchmark.h>

#include "recognition/descriptors/descriptor.h"
#include "tests/bench/frames.h"
#include "tests/bench/peer/peer_pcl.h"
#include "tests/bench/suite.h"

namespace graspdb::bench {
namespace {

using recognition::DescriptorKind;

std::size_t Ours(const Frame& frame) {
  const recognition::Scan scan = ScanOf(frame);
  recognition::StageLog log;
  const auto found = recognition::SegmentScan(
      scan, {}, {}, [] { return false; }, &log);
  std::size_t described = 0;
  if (!found.ok()) return described;
  for (const recognition::Segment& segment : found->segments) {
    described +=
        recognition::Describe(segment.cloud, found->world_sensor, DescriptorKind::kGsh288).ok();
  }
  return described;
}

std::size_t Peer(const Frame& frame) {
  const peer::Cloud::Ptr cloud = frame.depth.empty()
                                     ? peer::ToPcl(frame.points)
                                     : peer::Unproject(frame.depth, frame.camera, kDepthUnitM);
  return peer::Describe(cloud, frame.world_sensor, frame.region, {}, {}).size();
}

void Run(benchmark::State& state, std::size_t (*describe)(const Frame&), const Frames& frames_of) {
  const std::vector<const Frame*> frames = frames_of();
  std::size_t objects = 0;
  const Counted counted;
  for (auto _ : state) {
    objects = 0;
    for (const Frame* frame : frames) objects += describe(*frame);
    benchmark::DoNotOptimize(objects);
  }
  state.counters["objects"] = static_cast<double>(objects);
}

void Add(const std::string& name, const Frames& frames) {
  const std::string work = "frame to descriptor, " + name;
  Compare(work, "graspdb", [=](benchmark::State& state) { Run(state, Ours, frames); });
  Compare(work, "PCL", [=](benchmark::State& state) { Run(state, Peer, frames); });
}

}  // namespace

void AddSegmentation() {
  for (const std::string name : kSimulatedFrames) {
    Add(name, [=] { return std::vector{&SimulatedFrame(name)}; });
  }
  if (HasRealFrames()) Add("mosd (12 real frames)", [] { return PointersTo(RealFrames()); });
}

}  // namespace graspdb::bench
