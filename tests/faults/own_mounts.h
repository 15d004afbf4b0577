// Mounts of a test.
#pragma once

#include <sched.h>
#include <sys/mount.h>

namespace graspdb::faults {

// From now on, only this thread and the processes that it starts see what it mounts. Needs root;
// false without.
inline bool EnterOwnMounts() {
  return unshare(CLONE_NEWNS) == 0 &&
         mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
}

}  // namespace graspdb::faults
