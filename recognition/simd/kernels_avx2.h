// The functions for processors with AVX2, where they are built at all.
#pragma once

#include "recognition/simd/kernels.h"

namespace graspdb::recognition::simd {

const Functions& Avx2();

}  // namespace graspdb::recognition::simd
