// A program that runs until it is asked to stop.
#pragma once

#include <csignal>

namespace graspdb {

// Waits for SIGTERM or SIGINT. Made before any thread starts: threads that start later leave these
// signals to Wait.
class StopSignal {
 public:
  StopSignal();

  // Which of the two came.
  int Wait() const;

 private:
  sigset_t signals_;
};

}  // namespace graspdb
