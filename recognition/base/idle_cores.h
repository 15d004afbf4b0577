// Independent jobs on idle cores.
#pragma once

#include <cstddef>
#include <functional>

namespace graspdb::recognition {

// Calls `job` once with each index below `count`, on this thread and on helper threads while fewer
// threads than cores run such calls: one request is faster on an idle machine, and many are not
// slower on a busy one. Jobs must not write data that others read; the result then does not depend
// on the number of threads. Returns when all jobs are done and rethrows a job's exception. Jobs may
// call it recursively. Thread-safe.
void ForEachIndex(std::size_t count, const std::function<void(std::size_t)>& job);

}  // namespace graspdb::recognition
