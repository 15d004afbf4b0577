// Fusion of 24 views of an object on a turntable, as in the first request for a stable pose.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "recognition/models/surface_model.h"
#include "rendering/sample_parts.h"
#include "tests/bench/peer/peer_pcl.h"
#include "tests/bench/peer/peer_pcl_fusion.h"
#include "tests/bench/seen_parts.h"
#include "tests/bench/suite.h"
#include "tests/rendering/mesh_measure.h"

namespace graspdb::bench {
namespace {

// Neighbour radius of PCL's surface, equal to ours, m.
constexpr double kReachM = 0.006;

struct Views {
  explicit Views(const std::string& id) {
    for (rendering::Workpiece& part : rendering::SampleParts()) {
      if (part.object_id == id) parts.push_back(std::move(part));
    }
    for (SeenPart& seen : SeeParts(parts)) {
      const Eigen::Isometry3f object_world = seen.world_object.inverse().cast<float>();
      for (const Eigen::Vector3f& p : seen.cloud.points) all.push_back(object_world * p);
      clouds.push_back({std::make_shared<const recognition::OrientedCloud>(std::move(seen.cloud)),
                        seen.world_object});
    }
  }

  std::vector<rendering::Workpiece> parts;  // the one
  std::vector<recognition::PosedCloud> clouds;
  recognition::Points all;  // of all views, object frame, m
};

// Of the fused points from the true surface, root mean square.
template <typename Fused, typename PointAt>
void Report(const Views& views, const Fused& fused, const PointAt& point_at,
            benchmark::State* state) {
  double squares = 0;
  for (const auto& entry : fused) {
    const auto off = static_cast<double>(
        rendering::DistanceTo(views.parts.front().mesh, Eigen::Vector3f(point_at(entry))));
    squares += off * off;
  }
  const auto count = static_cast<double>(fused.size());
  state->counters["views"] = static_cast<double>(views.clouds.size());
  state->counters["points"] = count;
  state->counters["off_mm"] = 1000 * std::sqrt(squares / count);
}

void Ours(benchmark::State& state, const Views& views) {
  std::shared_ptr<const recognition::SurfaceModel> model;
  {
    const Counted counted;
    for (auto _ : state) model = recognition::FuseViews(views.clouds);
  }
  Report(
      views, model->fine.cloud.points, [](const Eigen::Vector3f& p) { return p; }, &state);
}

void Peer(benchmark::State& state, const Views& views) {
  const peer::Cloud::Ptr all = peer::ToPcl(views.all);
  peer::OrientedCloud::Ptr fused;
  {
    const Counted counted;
    for (auto _ : state) fused = peer::Fuse(all, recognition::kFusionCellM, kReachM);
  }
  Report(
      views, *fused, [](const pcl::PointNormal& p) { return p.getVector3fMap(); }, &state);
}

}  // namespace

void AddFusion() {
  for (const char* part : {"l-bracket", "post-plate", "wedge"}) {
    const Lazy<std::shared_ptr<const Views>> views(
        [=] { return std::make_shared<const Views>(part); });
    const std::string work = std::string("fusing one model, ") + part;
    Compare(work, "graspdb", [=](benchmark::State& state) { Ours(state, **views); });
    Compare(work, "PCL moving least squares",
            [=](benchmark::State& state) { Peer(state, **views); });
  }
}

}  // namespace graspdb::bench
