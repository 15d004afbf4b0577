#include "recognition/simd/kernel_bodies.h"

namespace graspdb::recognition::simd {

const Functions& Portable() {
  static constexpr Functions kFunctions = {"portable", GRASPDB_SIMD_FUNCTIONS};
  return kFunctions;
}

}  // namespace graspdb::recognition::simd
