// Inputs of both programs: frames and a catalogue, made once per run.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "recognition/base/types.h"
#include "recognition/segmentation/segmentation.h"
#include "rendering/camera/depth_camera.h"

namespace graspdb::bench {

// A frame of a calibrated cell.
struct Frame {
  std::string name;
  std::vector<std::uint16_t> depth;  // mm; empty for a frame of points
  recognition::CameraIntrinsics camera;
  recognition::Points points;  // sensor frame, m
  recognition::Pose world_sensor = recognition::Pose::Identity();
  recognition::Box region;
  std::size_t objects = 0;  // number in the frame
};

inline constexpr double kDepthUnitM = 0.001;

// The frame as input of the recognition.
recognition::Scan ScanOf(const Frame& frame);

// All below are made on first use. Not thread-safe.

// Sample parts on a table, simulated: the name gives the camera and the number of parts.
// "megapixel" is a time-of-flight camera with 1280 x 800 pixels.
inline constexpr std::array kSimulatedFrames = {"kinect-v1-one", "kinect-v1-five", "kinect-v2-one",
                                                "kinect-v2-five", "megapixel-one"};
const Frame& SimulatedFrame(const std::string& name);

// The frames of mosd_tabletop: 640 x 480, several objects; the world frame is from our own
// segmentation. Empty if the data are missing.
bool HasRealFrames();
const std::vector<Frame>& RealFrames();

// Frames for a benchmark, made when it runs.
using Frames = std::function<std::vector<const Frame*>()>;
std::vector<const Frame*> PointersTo(const std::vector<Frame>& frames);

// Each sample part alone, at two random poses on the table; Kinect v2. The names are those of the
// parts.
const std::vector<Frame>& PartFrames();

// The sample part of this id alone on the table, at `world_object`.
Frame FrameOf(const std::string& part, const rendering::DepthCameraModel& camera,
              const recognition::Pose& world_object);

}  // namespace graspdb::bench
