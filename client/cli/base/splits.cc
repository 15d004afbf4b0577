#include "client/cli/base/splits.h"

#include "files/capture_sets/capture_set.h"

namespace graspdb::client {

void AddSplitFlag(CLI::App& command, std::string* split) {
  command.add_option("--split", *split, "Captures to take: TEACH, QUERY or ALL")
      ->check(CLI::IsMember({"TEACH", "QUERY", "ALL"}))
      ->capture_default_str();
}

std::vector<const v1::Capture*> CapturesOfSplit(const v1::CaptureSet& set,
                                                const std::string& split) {
  if (split == "TEACH") return files::CapturesOf(set, v1::Capture::TEACH);
  if (split == "QUERY") return files::CapturesOf(set, v1::Capture::QUERY);
  return files::CapturesOf(set);
}

std::vector<const v1::Capture*> TeachableCaptures(const v1::CaptureSet& set,
                                                  const std::string& split) {
  std::vector<const v1::Capture*> out = CapturesOfSplit(set, split);
  std::erase_if(out, [](const v1::Capture* capture) {
    return capture->object_id().empty() || capture->stable_pose_id().empty();
  });
  return out;
}

}  // namespace graspdb::client
