// Built with -mavx2; nothing here may run before the processor was asked.
#include "recognition/wide_avx2.h"

#include "recognition/wide_body.h"

namespace graspdb::recognition::wide {

const Functions& Avx2() {
  static constexpr Functions kFunctions = {"AVX2", GRASPDB_WIDE_FUNCTIONS};
  return kFunctions;
}

}  // namespace graspdb::recognition::wide
