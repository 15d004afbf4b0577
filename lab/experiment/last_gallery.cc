#include "lab/experiment/last_gallery.h"

namespace graspdb::lab {

absl::StatusOr<Gallery*> LastGallery::Teach(const ExperimentCase& experiment, const PartSet& set,
                                            const TrialSource& teaching, const ExperimentRun& run) {
  std::vector<std::string> taught;
  for (std::size_t i = 0; i < set.taught_count; ++i) taught.push_back(StablePoseName(set.parts[i]));
  if (gallery_ != nullptr && taught == taught_ && TeachesAlike(experiment, experiment_)) {
    return gallery_.get();
  }
  gallery_ = std::make_unique<Gallery>(set.parts, run.parameters);
  absl::Status status = gallery_->Teach(teaching, experiment.name + ": teaching", run);
  experiment_ = experiment;
  taught_ = std::move(taught);
  if (status.ok()) return gallery_.get();
  gallery_.reset();
  return status;
}

}  // namespace graspdb::lab
