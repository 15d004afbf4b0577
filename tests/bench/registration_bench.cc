// Registration of a taught view to a scan: an object turned by half a step of the turntable and
// moved.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "recognition/matching/matching_parameters.h"
#include "recognition/matching/refinement.h"
#include "recognition/points/point_search.h"
#include "rendering/camera/depth_camera.h"
#include "tests/bench/frames.h"
#include "tests/bench/peer/peer_pcl.h"
#include "tests/bench/suite.h"

namespace graspdb::bench {
namespace {

using recognition::OrientedCloud;
using recognition::Pose;

// Visible points of a single object.
struct Look {
  recognition::Scan scan;
  recognition::Pose world_sensor = Pose::Identity();
  recognition::Segment segment;
};

Look LookAt(const std::string& part, const rendering::DepthCameraModel& camera,
            const Pose& world_object) {
  Look out;
  out.scan = ScanOf(FrameOf(part, camera, world_object));
  recognition::StageLog log;
  auto found = recognition::SegmentScan(
      out.scan, {}, {}, [] { return false; }, &log);
  out.world_sensor = found->world_sensor;
  out.segment = std::move(found->segments.front());
  return out;
}

// Lookup structures of the scan, made once per segment.
struct ScanLookUps {
  explicit ScanLookUps(const Look& look)
      : grid(look.segment.cloud.points, 0.003F, 0.021F),
        columns(look.segment.cloud),
        depth_buffer(look.scan, look.world_sensor, look.segment) {}

  recognition::NearestGrid grid;
  recognition::SoaCloud columns;
  recognition::DepthBuffer depth_buffer;
};

struct Pair {
  Pair(const std::string& part, const rendering::DepthCameraModel& camera) {
    moved.translation() << 0.004, -0.003, 0;
    moved.rotate(Eigen::AngleAxisd(7.5 * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
    taught = LookAt(part, camera, Pose::Identity());
    seen = LookAt(part, camera, moved);
    const recognition::PosedCloud view = {std::make_shared<OrientedCloud>(taught.segment.cloud),
                                          Pose::Identity()};
    model = recognition::FuseViews({&view, 1});
    guess.translation() = seen.segment.centroid - taught.segment.centroid;
    look_ups = std::make_unique<ScanLookUps>(seen);
  }

  Look taught;
  Look seen;
  Pose moved = Pose::Identity();  // from the taught to the true pose
  Pose guess = Pose::Identity();  // initial value for both programs
  std::shared_ptr<const recognition::SurfaceModel> model;
  std::unique_ptr<const ScanLookUps> look_ups;
};

// Errors of the taught points moved by `found`: from their true positions, and from the tangent
// planes of the scan.
void Report(const Pair& pair, const Pose& found, benchmark::State* state) {
  const recognition::Points& points = pair.taught.segment.cloud.points;
  const OrientedCloud& seen = pair.seen.segment.cloud;
  const recognition::PointSearch scan(seen.points);
  double off = 0;
  double residual = 0;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3d q = found * p.cast<double>();
    off += (pair.moved * p.cast<double>() - q).squaredNorm();
    const auto at = static_cast<std::size_t>(scan.Nearest(q.cast<float>()).index);
    residual += std::abs((q - seen.points[at].cast<double>()).dot(seen.normals[at].cast<double>()));
  }
  const auto count = static_cast<double>(points.size());
  state->counters["points"] = static_cast<double>(seen.points.size());
  state->counters["off_mm"] = 1000 * std::sqrt(off / count);
  state->counters["residual_mm"] = 1000 * residual / count;
}

void Ours(benchmark::State& state, const Pair& pair) {
  const ScanLookUps& at = *pair.look_ups;
  // Without the table constraint, which the others do not have.
  const recognition::RefinementTarget target{pair.seen.segment.cloud, at.columns, at.grid,
                                             at.depth_buffer,
                                             /*on_table=*/false};
  Pose found = Pose::Identity();
  {
    const Counted counted;
    for (auto _ : state) found = Refine(*pair.model, target, pair.guess, {}).world_object;
  }
  Report(pair, found, &state);
}

template <typename Cloud, typename Align>
void Peer(benchmark::State& state, const Pair& pair, const Cloud& taught, const Cloud& seen,
          const Align& align) {
  const Eigen::Matrix4f guess = pair.guess.cast<float>().matrix();
  peer::Alignment found;
  {
    const Counted counted;
    for (auto _ : state) {
      found = align(taught, seen, guess, recognition::MatchingParameters().max_correspondence_m);
    }
  }
  Report(pair, Pose(found.target_source.cast<double>()), &state);
}

void Add(const std::string& part, const std::string& camera_name,
         const rendering::DepthCameraModel& camera) {
  const Lazy<std::shared_ptr<const Pair>> pair(
      [=] { return std::make_shared<const Pair>(part, camera); });
  const std::string work = "one registration, " + part + ", " + camera_name;
  Compare(work, "graspdb", [=](benchmark::State& state) { Ours(state, **pair); });
  Compare(work, "PCL ICP", [=](benchmark::State& state) {
    Peer(state, **pair, peer::ToPcl((*pair)->taught.segment.cloud.points),
         peer::ToPcl((*pair)->seen.segment.cloud.points), peer::Align);
  });
  Compare(work, "PCL ICP with normals", [=](benchmark::State& state) {
    Peer(state, **pair, peer::ToPcl((*pair)->taught.segment.cloud),
         peer::ToPcl((*pair)->seen.segment.cloud), peer::AlignWithNormals);
  });
  Compare("look-ups of a segment, " + part + ", " + camera_name, "graspdb",
          [=](benchmark::State& state) {
            for (auto _ : state) benchmark::DoNotOptimize(ScanLookUps((*pair)->seen).grid.bytes());
          });
}

}  // namespace

void AddRegistration() {
  for (const char* part : {"l-bracket", "post-plate", "wedge"}) {
    Add(part, "kinect-v2", rendering::KinectV2());
  }
}

}  // namespace graspdb::bench
