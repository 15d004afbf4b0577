// A catalogue in memory, taught with the code that the server teaches with.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/eval/trial.h"
#include "recognition/clouds_in_memory.h"
#include "recognition/recognizer.h"

namespace graspdb::client {

// Views that were taught. Teaching is not thread-safe; asking is.
class Gallery : public recognition::CloudsInMemory {
 public:
  Gallery(const std::vector<Workpiece>& parts,
          const recognition::RecognitionParameters& parameters);

  // Teaches what a trial shows, as a view of its first object.
  absl::Status Teach(const Trial& trial);

  // What is taught; without view number `left_out` where one is given.
  recognition::CatalogueSnapshot Snapshot(std::optional<std::size_t> left_out = std::nullopt) const;

  // What the first view of a part shows with all that share its frame; null where there is none.
  std::shared_ptr<const recognition::SurfaceModel> ModelOf(const Workpiece& part);

 private:
  const std::vector<Workpiece>* parts_;
  recognition::RecognitionParameters parameters_;
  std::vector<recognition::IndexedView> views_;
};

// Resource names of a workpiece and of its stable pose.
std::string ObjectName(const Workpiece& part);
std::string StablePoseName(const Workpiece& part);

}  // namespace graspdb::client
