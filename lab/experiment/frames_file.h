// Frames of real cameras with what stands in them: a folder with frames.json.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// An object in a frame.
struct FrameObject {
  std::string object;          // empty: something that has no mesh
  std::filesystem::path mesh;  // empty where it has none
  double unit_m = 1;           // of the mesh
  // T_sensor_mesh, metres; absent: it is in the frame and its pose is unknown.
  std::optional<recognition::Pose> sensor_mesh;
};

struct RealFrame {
  std::string name;  // the file's, without folder and ending
  std::filesystem::path path;
  std::string sensor;       // in words
  std::string arrangement;  // in words
  std::vector<FrameObject> objects;
};

// Whether frames.json lies in `folder`.
bool HasFrames(const std::filesystem::path& folder);

// What `folder`/frames.json lists: an array of objects with "frame" (a point file), "sensor",
// "arrangement" and "objects", each of which has "object", "mesh", "meshUnit" ("m" or "mm") and
// "T_sensor_mesh" (4 x 4, rows); paths are relative to the folder. NOT_FOUND without that file;
// INVALID_ARGUMENT with the frame where it says something else.
absl::StatusOr<std::vector<RealFrame>> LoadFrames(const std::filesystem::path& folder);

// The same of the file's text. INVALID_ARGUMENT.
absl::StatusOr<std::vector<RealFrame>> ParseFrames(const std::string& text,
                                                   const std::filesystem::path& folder);

}  // namespace graspdb::client
