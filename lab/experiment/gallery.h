// A catalogue in memory, taught with the code that the server teaches with.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "lab/experiment/experiment_run.h"
#include "lab/experiment/trial_source.h"
#include "recognition/models/clouds_in_memory.h"
#include "recognition/recognizer.h"

namespace graspdb::client {

// Views that were taught. Teaching is not thread-safe; asking is.
class Gallery : public recognition::CloudsInMemory {
 public:
  Gallery(std::vector<Workpiece> parts, const recognition::RecognitionParameters& parameters);

  // Teaches what each trial shows, as a view of its first object, in their order. Errors as the
  // trials and SegmentScan, with the stable pose.
  absl::Status Teach(const TrialSource& trials, const std::string& step, const ExperimentRun& run);

  // What is taught; without view number `left_out` where one is given.
  recognition::CatalogueSnapshot Snapshot(std::optional<std::size_t> left_out = std::nullopt) const;

  // What the first view of a part shows with all that share its frame; null where there is none.
  std::shared_ptr<const recognition::SurfaceModel> ModelOf(const Workpiece& part);

 private:
  // A view before it is added.
  struct Described {
    recognition::IndexedView view;
    recognition::OrientedCloud cloud;
  };
  absl::StatusOr<Described> Describe(const Trial& trial, std::size_t number) const;

  std::vector<Workpiece> parts_;
  recognition::RecognitionParameters parameters_;
  std::vector<recognition::IndexedView> views_;
};

// Resource names of a workpiece and of its stable pose.
std::string ObjectName(const Workpiece& part);
std::string StablePoseName(const Workpiece& part);

}  // namespace graspdb::client
