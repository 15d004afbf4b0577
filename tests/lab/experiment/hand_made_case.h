// Case results that are written down, for tests of what is made from them.
#pragma once

#include <string>

#include "lab/experiment/experiment.h"
#include "lab/experiment/gallery.h"

namespace graspdb::client {

// Some sample parts, of which the last is not taught. Measured with a few points only, since these
// tests bring their errors with them.
PartSet HandMadeParts();

Answer RightAnswer(const PartSet& set, std::size_t part, std::size_t scene);

// Five questions: two right, one taken for another, one without an answer, one object that is not
// known and was rejected.
CaseResult HandMade(const std::string& name = "hidden-20");

}  // namespace graspdb::client
