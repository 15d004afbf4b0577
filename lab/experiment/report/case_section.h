// What the page says about one case.
#pragma once

#include <string>

#include "lab/experiment/experiment.h"

namespace graspdb::client {

// The id of a case's section in the page, for links; safe in an attribute.
std::string SectionId(const std::string& case_name);

// A <section> with the figures of the case. A case without answers says so.
std::string CaseSection(const CaseResult& result);

}  // namespace graspdb::client
