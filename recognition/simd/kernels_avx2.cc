// Built with -mavx2; nothing here may run before AVX2 support was checked.
#include "recognition/simd/kernels_avx2.h"

#include "recognition/simd/kernel_bodies.h"

namespace graspdb::recognition::simd {

const Functions& Avx2() {
  static constexpr Functions kFunctions = {"AVX2", GRASPDB_SIMD_FUNCTIONS};
  return kFunctions;
}

}  // namespace graspdb::recognition::simd
