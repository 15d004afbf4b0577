// The limit of file descriptors (ulimit -n): files, connections, and what libraries use themselves.
#pragma once

#include "absl/status/status.h"

namespace graspdb {

// Raises the limit of this process as far as it may. FAILED_PRECONDITION where that is too few to
// work with. To be called first in main(), before files are opened.
absl::Status RaiseDescriptorLimit();

// Descriptors that this process may have open.
int DescriptorLimit();

// Descriptors that this process has open; 0 where that is not known.
int CountDescriptors();

}  // namespace graspdb
