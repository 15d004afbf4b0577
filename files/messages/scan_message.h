// Scans in requests: depth images or clouds.
#pragma once

#include <utility>
#include <variant>

#include "graspdb/v1/geometry.pb.h"

namespace graspdb::files {

using ScanMessage = std::variant<v1::DepthImage, v1::PointCloud>;

// Makes it the scan of `message`, a RecognizeRequest or a View without a scan.
template <typename Message>
void SetScan(ScanMessage scan, Message* message) {
  if (auto* image = std::get_if<v1::DepthImage>(&scan)) {
    *message->mutable_depth_image() = std::move(*image);
  } else {
    *message->mutable_cloud() = std::move(std::get<v1::PointCloud>(scan));
  }
}

}  // namespace graspdb::files
