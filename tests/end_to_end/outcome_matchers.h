// Matchers for finished programs.
#pragma once

#include <gmock/gmock.h>

#include <ostream>
#include <string>

#include "tests/end_to_end/process.h"

namespace graspdb::end_to_end {

MATCHER_P(EndsWith, status, "ends with exit status " + std::to_string(status)) {
  *result_listener << "which ended with " << arg.exit_status << ", stderr: " << arg.err;
  return arg.exit_status == status;
}

// stderr is one line, from the named program, that contains `words`.
MATCHER_P2(PrintsOnly, program, words, "is one sentence with the given words") {
  *result_listener << "which wrote: " << arg.err;
  return arg.err.starts_with(std::string(program) + ": ") && arg.err.size() > 20 &&
         arg.err.find('\n') == arg.err.size() - 1 &&
         arg.err.find(std::string(words)) != std::string::npos;
}

}  // namespace graspdb::end_to_end
