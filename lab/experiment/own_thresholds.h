// Applies the thresholds that a catalogue's views propose.
#pragma once

#include "absl/status/statusor.h"
#include "lab/experiment/gallery.h"
#include "recognition/threshold_proposals.h"

namespace graspdb::lab {

// `taught` with the threshold of each stable pose from recognition::ProposeThresholds. Errors as
// there.
absl::StatusOr<recognition::CatalogueSnapshot> WithOwnThresholds(
    recognition::CatalogueSnapshot taught, const recognition::RecognitionParameters& parameters,
    const recognition::ThresholdProgress& report, Gallery* gallery);

}  // namespace graspdb::lab
