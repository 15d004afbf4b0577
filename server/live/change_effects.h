// The effects of a change of the catalogue on the views and stable poses in memory.
#pragma once

#include <string>
#include <unordered_set>
#include <vector>

#include "recognition/descriptors/descriptor.h"
#include "recognition/index/descriptor_index.h"
#include "server/live/taught_poses.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// The effects of one change on views and stable poses.
struct Effects {
  std::vector<recognition::IndexedView> added;
  std::unordered_set<std::string> removed;  // views; one that is written again is removed first
  TaughtPoseChange poses;
  std::vector<std::string> touched;   // names of all views and stable poses in the change
  std::vector<std::string> left_out;  // of these, those that are written and cannot be used
};

// Reads the after-images in a change. A record that cannot be used is left out and logged, the rest
// of the change takes effect: the same as when the server starts.
Effects EffectsOf(const storage::ChangeRecord& change, const TaughtPoses& known,
                  const recognition::DescriptorParameters& parameters);

// Collects all stable poses and their outcomes. A stable pose that cannot be used has no grasps and
// no symmetry, and its name is in `left_out`. Both outlive the visitor.
storage::RecordVisitor StablePoseVisitor(TaughtPoseChange* poses,
                                         std::vector<std::string>* left_out);

// Logs that the record of that name is not used.
void LogLeftOut(const std::string& name, const absl::Status& why);

}  // namespace graspdb::server
