#include "lab/experiment/trials/composites.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "base/status_macros.h"
#include "recognition/frame/frame.h"
#include "recognition/segmentation/region.h"
#include "recognition/segmentation/segmentation.h"
#include "rendering/camera/depth_camera.h"
#include "rendering/random/counter_random.h"

namespace graspdb::lab {
namespace {

using recognition::Frame;
using recognition::PixelRole;
using recognition::Pose;

constexpr int kAttempts = 40;  // to place an object
constexpr double kNextToShare = 0.5;
constexpr double kLeaningShare = 0.25;
constexpr double kMaxLeanRad = 0.5;
constexpr double kMinInView = 0.4;
constexpr std::size_t kMinObjectPixels = 200;
// So many pixels of others may lie inside of an object's box, which is smaller by the margin, m:
// noise. The boxes of round parts are larger than they are.
constexpr std::size_t kMaxInside = 15;
constexpr float kBoxMargin = 0.005F;

class Composer {
 public:
  // Parts are placed on the table within `region`.
  Composer(const RealFrame& background, const PartSet& set, Frame image,
           const recognition::Box& region, rendering::DepthCamera camera,
           const CompositeOptions& options)
      : set_(set),
        image_(std::move(image)),
        world_sensor_(image_.world_sensor),
        camera_(std::move(camera)),
        options_(options) {
    out_.frame = background;
    for (FrameObject& object : out_.frame.objects) object.sensor_mesh.reset();
    for (std::size_t i = 0; i < image_.role.size(); ++i) {
      if (image_.role[i] == PixelRole::kTable && region.Contains(WorldPoint(i))) {
        table_.push_back(i);
      }
      if (image_.role[i] == PixelRole::kObject) others_.push_back(WorldPoint(i));
    }
  }

  absl::StatusOr<Composite> Run() {
    if (table_.empty()) return absl::FailedPreconditionError("the frame shows no table");
    for (int i = 0; i < options_.objects; ++i) {
      RETURN_IF_ERROR(PlaceOne());
    }
    out_.scan.width = image_.camera.width;
    for (std::size_t i = 0; i < image_.depth.size(); ++i) {
      out_.scan.points.push_back(image_.depth[i] > 0 ? image_.PointAt(i, image_.depth[i])
                                                     : Eigen::Vector3f::Constant(std::nanf("")));
    }
    return std::move(out_);
  }

 private:
  double Random() { return rendering::RandomUniform(options_.seed, 0, counter_++); }
  std::size_t RandomBelow(std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(Random() * static_cast<double>(count)));
  }
  Eigen::Vector3d WorldPoint(std::size_t pixel) const {
    return world_sensor_ * image_.PointAt(pixel, image_.depth[pixel]).cast<double>();
  }

  // T_world_object of a part on the table.
  Pose RandomPose(const rendering::TriangleMesh& mesh) {
    Pose turned = Pose::Identity();
    turned.rotate(Eigen::AngleAxisd(2 * std::numbers::pi * Random(), Eigen::Vector3d::UnitZ()));
    if (Random() < kLeaningShare) {
      turned.rotate(Eigen::AngleAxisd(kMaxLeanRad * Random(), Eigen::Vector3d::UnitX()));
    }
    double lowest = 1e9;
    double reach = 0;
    for (const Eigen::Vector3f& vertex : mesh.vertices) {
      const Eigen::Vector3d p = turned * vertex.cast<double>();
      lowest = std::min(lowest, p.z());
      reach = std::max(reach, p.head<2>().norm());
    }
    const Eigen::Vector3d on_table = WorldPoint(table_[RandomBelow(table_.size())]);
    Eigen::Vector3d place = on_table;
    if (!others_.empty() && Random() < kNextToShare) {
      const double way = 2 * std::numbers::pi * Random();
      place = others_[RandomBelow(others_.size())] +
              reach * (0.5 + 0.6 * Random()) * Eigen::Vector3d(std::cos(way), std::sin(way), 0);
    }
    place.z() = on_table.z() - lowest;
    return Eigen::Translation3d(place) * turned;
  }

  std::size_t CountInside(const recognition::Box& box, const Pose& world_object,
                          const std::vector<Eigen::Vector3d>& points) const {
    const Pose object_world = world_object.inverse();
    const Eigen::Array3d low = box.min.array() + kBoxMargin;
    const Eigen::Array3d high = box.max.array() - kBoxMargin;
    return static_cast<std::size_t>(std::ranges::count_if(points, [&](const auto& point) {
      const Eigen::Array3d p = (object_world * point).array();
      return (p > low).all() && (p < high).all();
    }));
  }

  absl::Status PlaceOne() {
    for (int i = 0; i < kAttempts; ++i) {
      const std::size_t part = RandomBelow(set_.parts.size());
      const rendering::TriangleMesh& mesh = set_.parts[part].mesh;
      const Pose world_object = RandomPose(mesh);
      if (CountInside(rendering::BoundsOf(mesh), world_object, others_) > kMaxInside) continue;
      ASSIGN_OR_RETURN(const bool taken, Draw(part, world_object));
      if (taken) return absl::OkStatus();
    }
    return absl::OkStatus();
  }

  // Whether the part was drawn. The table is rendered with it: its pixels in the part's shadow are
  // lost.
  absl::StatusOr<bool> Draw(std::size_t part, const Pose& world_object) {
    const double table_height = WorldPoint(table_.front()).z();
    const Pose down(Eigen::Translation3d(0, 0, -table_height));
    rendering::Scene scene;
    scene.objects = {{&set_.parts[part].mesh, down * world_object}};
    scene.table_half_width_m = 3;
    const std::uint64_t seed = rendering::RandomBits(options_.seed, 1, counter_++);
    ASSIGN_OR_RETURN(const auto drawn, camera_.Render(scene, down * world_sensor_, seed));
    std::vector<std::size_t> pixels;
    std::size_t count = 0;
    for (std::size_t i = 0; i < drawn.depth_m.size(); ++i) {
      if (drawn.surface[i] != 0 && drawn.surface[i] != rendering::kFlyingPixel) continue;
      ++count;
      if (image_.depth[i] == 0 || drawn.depth_m[i] < image_.depth[i]) pixels.push_back(i);
    }
    const bool in_view =
        static_cast<double>(pixels.size()) > kMinInView * static_cast<double>(count);
    if (pixels.size() < kMinObjectPixels || !in_view) return false;
    std::vector<Eigen::Vector3d> points;
    points.reserve(pixels.size());
    for (const std::size_t i : pixels) {
      points.push_back(world_sensor_ * image_.PointAt(i, drawn.depth_m[i]).cast<double>());
    }
    for (const auto& [box, pose] : boxes_) {
      if (CountInside(box, pose, points) > kMaxInside) return false;
    }
    for (std::size_t i = 0; i < drawn.depth_m.size(); ++i) {
      const bool is_shadow = drawn.depth_m[i] == 0 && image_.role[i] == PixelRole::kTable;
      if (is_shadow) image_.depth[i] = 0;
    }
    for (const std::size_t i : pixels) {
      image_.depth[i] = drawn.depth_m[i];
      image_.role[i] = PixelRole::kObject;
    }
    std::erase_if(table_, [&](std::size_t i) {
      return image_.depth[i] == 0 || image_.role[i] != PixelRole::kTable;
    });
    others_.insert(others_.end(), points.begin(), points.end());
    boxes_.emplace_back(rendering::BoundsOf(set_.parts[part].mesh), world_object);
    out_.frame.objects.push_back(
        {.object = set_.parts[part].object_id,
         .mesh = {},
         .unit_m = 1,
         .sensor_mesh = world_sensor_.inverse() * world_object * set_.object_mesh[part]});
    return true;
  }

  const PartSet& set_;
  Frame image_;
  const Pose world_sensor_;
  const rendering::DepthCamera camera_;
  const CompositeOptions options_;
  std::uint64_t counter_ = 0;
  std::vector<std::size_t> table_;       // pixels
  std::vector<Eigen::Vector3d> others_;  // points of what stands on the table, world frame
  std::vector<std::pair<recognition::Box, Pose>> boxes_;  // of what was placed
  Composite out_;
};

}  // namespace

absl::StatusOr<Composite> Compose(const RealFrame& background, const recognition::Scan& scan,
                                  const PartSet& set,
                                  const recognition::RecognitionParameters& parameters,
                                  const CompositeOptions& options) {
  const auto never = [] { return false; };
  recognition::StageLog log;
  ASSIGN_OR_RETURN(
      const auto segmentation,
      recognition::SegmentScan(scan, parameters.segmentation, parameters.descriptor, never, &log));
  const Pose& world_sensor = segmentation.world_sensor;
  if (!segmentation.region) return absl::FailedPreconditionError("the frame is one object");
  const recognition::Box& region = *segmentation.region;
  Frame image = recognition::MakeFrame(scan, world_sensor, segmentation.table, region,
                                       parameters.scene.frame, never);
  if (image.camera.width == 0) return absl::FailedPreconditionError("the frame is no image");
  constexpr std::array<rendering::DepthCameraModel (*)(), 4> kCameras = {
      rendering::RealKinectV1, rendering::RealKinectV2, rendering::RealSenseD4xx,
      rendering::Carmine};
  rendering::DepthCameraModel model =
      kCameras[rendering::RandomBits(options.seed, 2, 0) % kCameras.size()]();
  model.intrinsics = image.camera;
  ASSIGN_OR_RETURN(auto camera, rendering::DepthCamera::Create(model));
  auto composite =
      Composer(background, set, std::move(image), region, std::move(camera), options).Run();
  if (composite.ok()) composite->scan.world_sensor = scan.world_sensor;
  return composite;
}

}  // namespace graspdb::lab
