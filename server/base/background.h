// Work with lower priority than the robots' frames.
#pragma once

#include <functional>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"

namespace graspdb::server {

// Lowers the priority of the calling thread: it gets idle cores, and about a tenth of a busy one.
// Cannot be undone without privileges, so it is for threads that end with their work. Does nothing
// where the system has no thread priorities.
void LowerPriority();

// Runs `work`, and converts its exceptions, mostly std::bad_alloc, to INTERNAL: a thread of the
// server's own or a listener must not throw.
absl::Status Guarded(absl::FunctionRef<absl::Status()> work);

// Runs `work` on a thread of its own with lower priority, and waits for it. Rethrows exceptions of
// `work`. Thread-safe.
absl::Status InBackground(const std::function<absl::Status()>& work);

}  // namespace graspdb::server
