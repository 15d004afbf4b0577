// Caches the last gallery, for cases with the same catalogue.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lab/experiment/cases.h"
#include "lab/experiment/gallery.h"

namespace graspdb::lab {

// One gallery. For rendered trials of one run, in which names of meshes are unique.
class LastGallery {
 public:
  // The gallery of `teaching`; kept until another one is requested. Errors as Gallery::Teach.
  absl::StatusOr<Gallery*> Teach(const ExperimentCase& experiment, const PartSet& set,
                                 const TrialSource& teaching, const ExperimentRun& run);

 private:
  std::unique_ptr<Gallery> gallery_;
  ExperimentCase experiment_;
  std::vector<std::string> taught_;  // stable poses
};

}  // namespace graspdb::lab
