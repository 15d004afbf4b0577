// Independent jobs on the cores that nobody uses.
#pragma once

#include <cstddef>
#include <functional>

namespace graspdb::recognition {

// Calls `job` once with each number below `count`: on this thread, and on others as long as fewer
// threads than the machine has cores are in such calls, so that one request is faster on an idle
// machine and many are not slower on a busy one. Jobs must not write what others read; then the
// result does not depend on how many threads there are. Returns when all jobs are done; an
// exception of one is thrown here. Jobs may call it in turn. Thread-safe.
void ForEachIndex(std::size_t count, const std::function<void(std::size_t)>& job);

}  // namespace graspdb::recognition
