// Fixed case results for tests of reports.
#pragma once

#include <string>

#include "lab/experiment/experiment.h"
#include "lab/experiment/gallery.h"

namespace graspdb::lab {

// Some sample parts, of which the last is not taught. Measured with a few points only, since the
// errors of these tests are fixed.
PartSet HandMadeParts();

Answer RightAnswer(const PartSet& set, std::size_t part, std::size_t scene);

// Five queries: two right, one wrong object, one without an answer, one unknown object that was
// rejected.
CaseResult HandMade(const std::string& name = "hidden-20");

}  // namespace graspdb::lab
