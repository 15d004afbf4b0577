// Work that gives way to the robots' frames.
#pragma once

#include <functional>

#include "absl/status/status.h"

namespace graspdb::server {

// From now on the calling thread gets a core only where others leave one, mostly: about a tenth
// where they do not. There is no way back without privileges, so it is for threads that end with
// their work. Where the system knows no priorities of threads, nothing happens.
void LowerPriority();

// Does `work` on a thread of its own that gives way, and waits for it. What `work` throws comes
// out here. Thread-safe.
absl::Status InBackground(const std::function<absl::Status()>& work);

}  // namespace graspdb::server
