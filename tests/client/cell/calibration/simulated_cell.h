// A cell with a robot, a depth camera and known ground truth.
#pragma once

#include <cstdint>
#include <random>
#include <string>

#include "client/cell/calibration/hand_eye.h"
#include "client/cell/sensors/depth_sensor.h"
#include "recognition/base/types.h"
#include "rendering/camera/depth_camera.h"
#include "rendering/workpiece.h"

namespace graspdb::testing {

// Either a camera beside the table and a part in the gripper, or a camera on the flange and a part
// on the table. Renders frames at the robot's current pose. Deterministic.
class SimulatedCell : public client::DepthSensor {
 public:
  SimulatedCell(client::CameraMount mount, const std::string& part,
                const rendering::DepthCameraModel& camera, std::uint64_t seed);

  // Drives to the next pose of a calibration, the tool tilted by up to `tilt_rad` to any side and
  // turned about its own axis by up to `turn_rad`; returns the robot's reported pose.
  recognition::Pose Drive(double tilt_rad, double turn_rad);
  // Drives to pose `number` of the program in docs/calibration.md: tilted by `tilt_rad` in a
  // direction that advances by 150 degrees each time, and turned by `turn_rad` to alternating
  // sides; returns the reported pose.
  recognition::Pose DriveProgram(int number, double tilt_rad, double turn_rad);
  void set_hidden(bool hidden) { hidden_ = hidden; }

  absl::StatusOr<client::SensorFrame> Next(MonotonicTime deadline) override;
  bool IsReady() override { return true; }
  std::string Name() const override { return "a simulated camera"; }

  // Of a fixed camera.
  recognition::Pose world_camera() const { return world_camera_; }
  // T_base_camera or T_flange_camera.
  recognition::Pose mount_camera() const;
  // T_camera_target at the robot's current pose.
  recognition::Pose camera_target() const;

 private:
  // Approximate position of a pose.
  struct Place {
    Eigen::Vector3d world_shown;  // a target in the gripper, before a fixed camera
    double distance_m = 0;        // of a camera on the flange from its target
  };
  recognition::Pose DriveTo(const Place& place, const Eigen::Vector3d& tilt, double turn_rad);
  double Uniform() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Eigen::Vector3d Normals();
  recognition::Pose WorldCameraNow() const;
  recognition::Pose WorldTargetNow() const;

  const client::CameraMount mount_;
  const rendering::Workpiece& part_;
  rendering::DepthCamera camera_;
  rendering::TriangleMesh gripper_;  // frame of the flange
  std::mt19937_64 random_;
  bool hidden_ = false;
  recognition::Pose world_base_ = recognition::Pose::Identity();
  recognition::Pose world_camera_ = recognition::Pose::Identity();   // of a fixed one
  recognition::Pose flange_camera_ = recognition::Pose::Identity();  // of one on the flange
  recognition::Pose flange_target_ = recognition::Pose::Identity();  // in the gripper
  recognition::Pose world_target_ = recognition::Pose::Identity();   // on the table
  recognition::Pose base_flange_ = recognition::Pose::Identity();    // true pose of the robot
};

}  // namespace graspdb::testing
