// Labelled frames of real cameras: a folder with frames.json.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"

namespace graspdb::lab {

// An object in a frame.
struct FrameObject {
  std::string object;          // empty: something that has no mesh
  std::filesystem::path mesh;  // empty where it has none
  double unit_m = 1;           // of the mesh
  // T_sensor_mesh, metres; absent: the pose is unknown.
  std::optional<recognition::Pose> sensor_mesh;
};

struct RealFrame {
  std::string name;  // of the file, without folder and extension
  std::filesystem::path path;
  std::string sensor;       // in words
  std::string arrangement;  // in words
  std::vector<FrameObject> objects;
};

// Whether `folder` contains frames.json.
bool HasFrames(const std::filesystem::path& folder);

// Reads `folder`/frames.json: an array of objects with "frame" (a point file), "sensor",
// "arrangement" and "objects", each of which has "object", "mesh", "meshUnit" ("m" or "mm") and
// "T_sensor_mesh" (4 x 4, rows, metres); paths are relative to the folder. NOT_FOUND without that
// file, FAILED_PRECONDITION if it cannot be read; INVALID_ARGUMENT with the frame for other
// content, an object more than 100 m away, and an object with two meshes.
absl::StatusOr<std::vector<RealFrame>> LoadFrames(const std::filesystem::path& folder);

// The same from the file's text. INVALID_ARGUMENT.
absl::StatusOr<std::vector<RealFrame>> ParseFrames(const std::string& text,
                                                   const std::filesystem::path& folder);

}  // namespace graspdb::lab
