// Checks after an input of a fuzzer.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace graspdb::fuzz {

// Ends the process if `holds` is false, which libFuzzer reports with the input; in every build
// type, unlike assert.
inline void Require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "violated: %s\n", what);
  std::abort();
}

}  // namespace graspdb::fuzz
