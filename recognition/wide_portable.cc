#include "recognition/wide_body.h"

namespace graspdb::recognition::wide {

const Functions& Portable() {
  static constexpr Functions kFunctions = {"portable", GRASPDB_WIDE_FUNCTIONS};
  return kFunctions;
}

}  // namespace graspdb::recognition::wide
