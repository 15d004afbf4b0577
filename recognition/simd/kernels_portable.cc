#include "recognition/simd/kernel_bodies.h"

namespace graspdb::recognition::simd {

const Functions& Portable() {
  static constexpr Functions kFunctions = {"portable", GRASPDB_WIDE_FUNCTIONS};
  return kFunctions;
}

}  // namespace graspdb::recognition::simd
