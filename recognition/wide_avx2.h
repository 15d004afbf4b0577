// The functions for processors with AVX2, where they are built at all.
#pragma once

#include "recognition/wide.h"

namespace graspdb::recognition::wide {

const Functions& Avx2();

}  // namespace graspdb::recognition::wide
