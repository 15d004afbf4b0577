// The picture of a match, after figures 10 and 16 of the paper.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "recognition/base/types.h"

namespace graspdb::pictures {

// The content of a picture; all points in the world frame, metres.
struct MatchPicture {
  std::string caption;
  recognition::Pose world_sensor = recognition::Pose::Identity();  // T_world_sensor
  Eigen::Vector3d center = Eigen::Vector3d::Zero();                // centre of the picture
  recognition::Points scan;                                        // white
  recognition::Points table;                                       // grey
  recognition::Points found;                   // green, left: the view where it was taught
  recognition::Points shifted;                 // green, middle: at the scan's centroid
  recognition::Points refined;                 // green, right: after the alignment
  std::optional<recognition::Pose> world_tcp;  // the grasp's axes: x red, y green, z blue
};

// Writes a PNG of three panels. FAILED_PRECONDITION when the file cannot be written.
absl::Status WriteMatchPicture(const std::filesystem::path& path, const MatchPicture& picture);

}  // namespace graspdb::pictures
