#include "lab/datasets/bigbird_calibration.h"

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "lab/datasets/hdf5_file.h"

namespace graspdb::client {
namespace {

namespace fs = std::filesystem;
using recognition::Pose;

constexpr double kRigidTolerance = 1e-3;
// Depth maps count in 0.1 mm before the camera's own scale.
constexpr double kStepM = 1e-4;

absl::StatusOr<Pose> ReadPose(const fs::path& path, const std::string& name) {
  const auto matrix = ReadHdf5(path, name, 4, 4);
  if (!matrix.ok()) return matrix.status();
  const Eigen::Matrix3d rotation = matrix->topLeftCorner<3, 3>();
  const bool is_rigid =
      (matrix->row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() < kRigidTolerance &&
      (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <
          kRigidTolerance &&
      rotation.determinant() > 0;
  if (!is_rigid) {
    return absl::InvalidArgumentError(absl::StrCat(
        path.string(), ": ", name, " is no rigid transform; copy the file again or calibrate"));
  }
  Pose out = Pose::Identity();
  out.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  out.translation() = matrix->topRightCorner<3, 1>();
  return out;
}

// The first of two datasets that is there.
absl::StatusOr<Eigen::MatrixXd> ReadEither(const fs::path& path, const std::string& first,
                                           const std::string& second, int rows, int columns) {
  auto values = ReadHdf5(path, first, rows, columns);
  return absl::IsNotFound(values.status()) ? ReadHdf5(path, second, rows, columns) : values;
}

}  // namespace

absl::StatusOr<Pose> ReadTablePose(const fs::path& object, int turn_deg) {
  return ReadPose(object / "poses" / absl::StrCat(kBigBirdReference, "_", turn_deg, "_pose.h5"),
                  "H_table_from_reference_camera");
}

absl::StatusOr<Pose> ReadRgbPose(const fs::path& object, const std::string& camera) {
  if (camera == kBigBirdReference) return Pose::Identity();
  return ReadPose(object / kBigBirdCalibrationFile,
                  absl::StrCat("H_", camera, "_from_", kBigBirdReference));
}

absl::StatusOr<Pose> ReadIrPose(const fs::path& object, const std::string& camera) {
  return ReadPose(object / kBigBirdCalibrationFile,
                  absl::StrCat("H_", camera, "_ir_from_", kBigBirdReference));
}

absl::StatusOr<DepthLens> ReadLens(const fs::path& object, const std::string& camera) {
  const fs::path path = object / kBigBirdCalibrationFile;
  const auto k = ReadEither(path, camera + "_depth_K", camera + "_ir_K", 3, 3);
  if (!k.ok()) return k.status();
  const auto d = ReadEither(path, camera + "_depth_d", camera + "_ir_d", 5, 1);
  if (!d.ok()) return d.status();
  const auto scale = ReadHdf5(path, camera + "_ir_depth_scale", 1, 1);
  if (!scale.ok()) return scale.status();
  DepthLens out{.fx = (*k)(0, 0),
                .fy = (*k)(1, 1),
                .cx = (*k)(0, 2),
                .cy = (*k)(1, 2),
                .step_m = kStepM * (*scale)(0, 0)};
  for (std::size_t i = 0; i < out.distortion.size(); ++i) {
    out.distortion[i] = (*d)(static_cast<Eigen::Index>(i), 0);
  }
  if (out.fx > 0 && out.fy > 0 && out.step_m > 0) return out;
  return absl::InvalidArgumentError(
      absl::StrCat(path.string(), ": a focal length or the depth scale of ", camera,
                   " is not positive; copy the file again or calibrate"));
}

}  // namespace graspdb::client
