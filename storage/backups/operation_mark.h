// One long operation at a time. Internal to storage/.
#pragma once

#include <atomic>
#include <string>

#include "absl/status/status.h"

namespace graspdb::storage {

// Marks that an operation runs, unless another one does.
class OperationMark {
 public:
  explicit OperationMark(std::atomic<bool>& running)
      : running_(running), is_first_(!running.exchange(true)) {}
  ~OperationMark() {
    if (is_first_) running_ = false;
  }
  OperationMark(const OperationMark&) = delete;
  OperationMark& operator=(const OperationMark&) = delete;

  absl::Status Check(const std::string& directory) const {
    if (is_first_) return absl::OkStatus();
    return absl::AbortedError("another operation on the backups in " + directory +
                              " is running; try again when it has ended");
  }

 private:
  std::atomic<bool>& running_;
  const bool is_first_;
};

}  // namespace graspdb::storage
