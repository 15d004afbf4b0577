// Waiting for a signal to stop.
#pragma once

#include <csignal>

namespace graspdb {

// Waits for SIGTERM or SIGINT. To be constructed before any thread starts: later threads block
// these signals, so that Wait gets them.
class StopSignal {
 public:
  StopSignal();

  // Returns the received signal.
  int Wait() const;
  // Whether Wait() would return at once. For the thread that constructed this. Less than 1 us.
  bool IsPending() const;

 private:
  sigset_t signals_;
};

}  // namespace graspdb
