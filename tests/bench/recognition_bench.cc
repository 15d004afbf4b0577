// What a frame costs, step by step: a simulated Kinect v2 sees one workpiece on a table.
#include <benchmark/benchmark.h>

#include <memory>
#include <random>

#include "client/sensors/depth_camera.h"
#include "client/sensors/sample_parts.h"
#include "recognition/descriptor_index.h"
#include "recognition/registration.h"
#include "recognition/segmentation.h"

namespace graspdb {
namespace {

using recognition::Pose;

// One frame of the first sample part, rendered once.
struct Frame {
  recognition::Scan scan;
  recognition::Segment segment;
};

const Frame& OneFrame() {
  static const Frame frame = [] {
    Frame out;
    const client::Workpiece part = client::SampleParts().front();
    client::Scene scene;
    scene.objects.push_back({&part.mesh, Pose::Identity()});
    const auto camera = client::DepthCamera::Create(client::KinectV2());
    const Pose world_sensor = client::LookAt(Eigen::Vector3d::Zero(), 0.8, 40, 0);
    const auto image = camera->Render(scene, world_sensor, /*seed=*/1);
    out.scan.points = client::ToPoints(*image, camera->model().intrinsics);
    out.scan.world_sensor = world_sensor;
    recognition::StageLog log;
    out.segment = recognition::SegmentScan(
                      out.scan, {}, {}, [] { return false; }, &log)
                      ->segments.front();
    return out;
  }();
  return frame;
}

void FrameToSegments(benchmark::State& state) {
  const Frame& frame = OneFrame();
  for (auto _ : state) {
    recognition::StageLog log;
    benchmark::DoNotOptimize(recognition::SegmentScan(
        frame.scan, {}, {}, [] { return false; }, &log));
  }
}
BENCHMARK(FrameToSegments)->Unit(benchmark::kMillisecond);

void SegmentToDescriptor(benchmark::State& state) {
  const Frame& frame = OneFrame();
  const Eigen::Vector3d viewpoint = frame.scan.world_sensor->translation();
  for (auto _ : state) {
    benchmark::DoNotOptimize(recognition::Describe(frame.segment.cloud, viewpoint,
                                                   recognition::DescriptorKind::kMvfh300));
  }
}
BENCHMARK(SegmentToDescriptor)->Unit(benchmark::kMillisecond);

void NearestViews(benchmark::State& state) {
  std::mt19937 random(1);
  std::vector<recognition::IndexedView> views(static_cast<std::size_t>(state.range(0)));
  for (recognition::IndexedView& view : views) {
    auto taught = std::make_shared<recognition::TaughtView>();
    taught->name = std::to_string(random());
    view.view = taught;
    view.descriptor.resize(300);
    for (float& bin : view.descriptor) bin = static_cast<float>(random() % 1000) / 150'000.0F;
  }
  const recognition::DescriptorIndex index = recognition::DescriptorIndex(300).With(views);
  for (auto _ : state) benchmark::DoNotOptimize(index.Nearest(views.front().descriptor, 10));
}
BENCHMARK(NearestViews)->Arg(1'000)->Arg(10'000)->Unit(benchmark::kMillisecond);

void Registration(benchmark::State& state) {
  const Frame& frame = OneFrame();
  const recognition::PointSearch search(frame.segment.cloud.points);
  Pose offset = Pose::Identity();
  offset.translation() = Eigen::Vector3d(0.004, -0.003, 0.002);
  offset.linear() = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()).matrix();
  recognition::MatchingParameters parameters;
  parameters.metric = state.range(0) == 0 ? recognition::IcpMetric::kPointToPoint
                                          : recognition::IcpMetric::kPointToPlane;
  for (auto _ : state) {
    benchmark::DoNotOptimize(recognition::Align(frame.segment.cloud.points,
                                                {frame.segment.cloud, search}, offset, parameters));
  }
}
BENCHMARK(Registration)->ArgName("to_plane")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace graspdb
