// Opens depth cameras by name, e.g. from a config file.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/sensors/depth_sensor.h"

namespace graspdb::client {

// Opens the sensor that `spec` names:
//
//   files:PATH[?loop&rate=HZ]       point files and depth images, see file_sensor.h
//   simulated[:KEY=VALUE,...]       random scenes of sample parts; parts=ID+ID, camera=v1|v2, seed,
//                                   objects-per-scene, area, look-down, distance, noise as the
//                                   flags of `graspdb simulate`; scene=FOLDER: the scene in that
//                                   folder instead, see scene_file.h
//   push:PORT or HOST:PORT          frames that another program pushes, see push_sensor.h; with
//                                   ?allow-remote also from other machines
//   genicam[:ID]                    GigE Vision and USB3 Vision, if built with Aravis, see
//                                   genicam_sensor.h; ?format, ?latency (s)
//   v4l2:/dev/videoN                Z16 images of Video4Linux, see v4l2_sensor.h; the camera by
//                                   ?intrinsics=FILE or fx, fy, cx, cy; ?unit (m), ?latency (s)
//   freenect[:N or SERIAL]          Kinect v1, see freenect_sensor.h
//   openni2[:URI or FILE.oni[?loop]]  cameras of OpenNI 2 and their recordings
//   freenect2[:SERIAL]              Kinect v2, if built with libfreenect2
//
// Cameras are opened in the background, and reopened after they were unplugged: without the camera
// this succeeds, and Next is UNAVAILABLE until it is connected. No frame is older than
// settings.max_age.
//
// INVALID_ARGUMENT for an unknown kind or option; UNIMPLEMENTED for a kind that is not built in;
// the errors of files and simulations, which are opened at once.
absl::StatusOr<std::unique_ptr<DepthSensor>> OpenSensor(const std::string& spec,
                                                        const SensorSettings& settings);

// A kind of sensor, and the connected cameras of this kind.
struct SensorListing {
  std::string kind;
  std::string what;  // description
  bool is_built = true;
  std::string package = {};                 // that provides it
  std::vector<std::string> connected = {};  // as specs
  std::string trouble = {};                 // why none was found; empty: there is no list
};

// Lists all kinds; may take some seconds. Includes cameras that another program uses.
std::vector<SensorListing> ListSensors();

// One line per kind, followed by one per camera.
std::string SensorsText(const std::vector<SensorListing>& listing);

}  // namespace graspdb::client
