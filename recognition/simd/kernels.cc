#include "recognition/simd/kernels.h"

#include "recognition/simd/kernels_avx2.h"

namespace graspdb::recognition::simd {

const Functions& Best() {
#ifdef GRASPDB_HAS_AVX2
  static const Functions& best = __builtin_cpu_supports("avx2") ? Avx2() : Portable();
  return best;
#else
  return Portable();
#endif
}

}  // namespace graspdb::recognition::simd
