#include "tests/lab/datasets/bigbird_folder.h"

#include <cmath>
#include <map>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "files/point_file.h"
#include "rendering/depth_camera.h"
#include "rendering/mesh_file.h"
#include "tests/lab/datasets/hdf5_writer.h"

namespace graspdb::client {
namespace {

namespace fs = std::filesystem;
using recognition::Pose;

// Steps of a depth map are these tenths of a millimetre.
constexpr double kDepthScale = 1.02;
constexpr double kFirstTurnDeg = 20;

Pose Turn(double degrees, const Eigen::Vector3d& axis) {
  return Pose(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis));
}

struct Rig {
  std::map<std::string, Pose> lab_rgb;
  std::map<std::string, Pose> lab_ir;
};

Rig MakeRig() {
  Pose rgb_ir = Turn(1.5, Eigen::Vector3d(1, 2, 3).normalized());
  rgb_ir.translation() << -0.025, 0.003, 0.002;
  Rig out;
  const double look_down_deg[] = {12, 26, 40, 60, 84};
  for (int i = 0; i < 5; ++i) {
    const std::string name = absl::StrCat("NP", i + 1);
    out.lab_rgb[name] = LookAt({0.01, 0, 0.04}, 0.75, look_down_deg[i], -90 + 4 * i);
    out.lab_ir[name] = out.lab_rgb[name] * rgb_ir;
  }
  return out;
}

// T_lab_table of the table's frame in the files.
Pose LabTable(int turn_deg, bool upside_down) {
  const Pose up = Turn(kFirstTurnDeg + turn_deg, Eigen::Vector3d::UnitZ());
  return upside_down ? up * Turn(180, Eigen::Vector3d::UnitX()) : up;
}

DepthCameraModel Camera() {
  DepthCameraModel out = KinectV1();
  out.noise.scale = 0;
  return out;
}

void WriteCalibration(const fs::path& folder, const Rig& rig) {
  const recognition::CameraIntrinsics k = Camera().intrinsics;
  const Pose& reference = rig.lab_rgb.at("NP5");
  Hdf5Writer file(folder / "calibration.h5");
  for (const auto& [name, lab_rgb] : rig.lab_rgb) {
    file.Add(absl::StrCat("H_", name, "_from_NP5"), (lab_rgb.inverse() * reference).matrix())
        .Add(absl::StrCat("H_", name, "_ir_from_NP5"),
             (rig.lab_ir.at(name).inverse() * reference).matrix())
        .Add(name + "_ir_K",
             (Eigen::Matrix3d() << k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1).finished())
        .Add(name + "_ir_d", Eigen::MatrixXd::Zero(5, 1))
        .Add(name + "_ir_depth_scale", Eigen::MatrixXd::Constant(1, 1, kDepthScale));
  }
}

absl::Status WriteCloud(const fs::path& path, const DepthFrame& frame, const Pose& rgb_ir) {
  const recognition::Points points = ToPoints(frame, Camera().intrinsics);
  PointFile file;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (frame.surface[i] == 0) file.points.emplace_back(rgb_ir.cast<float>() * points[i]);
  }
  file.width = static_cast<int>(file.points.size());
  file.height = 1;
  return WritePcd(path, file);
}

void WriteDepthMap(const fs::path& path, const DepthFrame& frame) {
  std::vector<std::uint16_t> steps;
  for (const float depth : frame.depth_m) {
    steps.push_back(static_cast<std::uint16_t>(std::lround(depth / (1e-4 * kDepthScale))));
  }
  Hdf5Writer(path).Add("depth", frame.height, frame.width, steps);
}

absl::Status WriteViews(const fs::path& folder, const Workpiece& part, int turn_deg, const Rig& rig,
                        const BigBirdPlan& plan) {
  const auto camera = DepthCamera::Create(Camera());
  if (!camera.ok()) return camera.status();
  const Pose lab_part = LabTable(turn_deg, /*upside_down=*/false) * TablePart();
  const Scene scene{.objects = {{.mesh = &part.mesh, .world_object = lab_part}},
                    .table_half_width_m = 0.2};
  for (const std::string& name : plan.cameras) {
    const auto frame = camera->Render(scene, rig.lab_ir.at(name), /*seed=*/1);
    if (!frame.ok()) return frame.status();
    const std::string view = absl::StrCat(name, "_", turn_deg);
    if (plan.with_clouds) {
      absl::Status written = WriteCloud(folder / "clouds" / (view + ".pcd"), *frame,
                                        rig.lab_rgb.at(name).inverse() * rig.lab_ir.at(name));
      if (!written.ok()) return written;
    } else {
      WriteDepthMap(folder / (view + ".h5"), *frame);
    }
  }
  return absl::OkStatus();
}

}  // namespace

Pose TablePart() {
  Pose out = Turn(30, Eigen::Vector3d::UnitZ());
  out.translation() << 0.02, -0.015, 0;
  return out;
}

absl::Status WriteBigBird(const fs::path& folder, const std::vector<Workpiece>& parts,
                          const BigBirdPlan& plan) {
  const Rig rig = MakeRig();
  for (const Workpiece& part : parts) {
    const fs::path of_part = folder / part.object_id;
    WriteCalibration(of_part, rig);
    for (int turn = 0; turn < 360; turn += plan.step_deg) {
      const Pose lab_table = LabTable(turn, plan.upside_down);
      Hdf5Writer(of_part / "poses" / absl::StrCat("NP5_", turn, "_pose.h5"))
          .Add("H_table_from_reference_camera",
               (lab_table.inverse() * rig.lab_rgb.at("NP5")).matrix());
      absl::Status written = WriteViews(of_part, part, turn, rig, plan);
      if (!written.ok()) return written;
    }
    if (!plan.with_meshes) continue;
    const Pose table_part =
        LabTable(0, plan.upside_down).inverse() * LabTable(0, false) * TablePart();
    absl::Status written =
        WriteMeshPly(of_part / "textured_meshes" / "optimized_poisson_textured_mesh.ply",
                     Transformed(part.mesh, table_part));
    if (!written.ok()) return written;
  }
  return absl::OkStatus();
}

}  // namespace graspdb::client
