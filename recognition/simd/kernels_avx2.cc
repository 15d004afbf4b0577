// Built with -mavx2; nothing here may run before the processor was asked.
#include "recognition/simd/kernels_avx2.h"

#include "recognition/simd/kernel_bodies.h"

namespace graspdb::recognition::simd {

const Functions& Avx2() {
  static constexpr Functions kFunctions = {"AVX2", GRASPDB_WIDE_FUNCTIONS};
  return kFunctions;
}

}  // namespace graspdb::recognition::simd
