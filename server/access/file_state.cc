#include "server/access/file_state.h"

#include "absl/time/clock.h"

namespace graspdb::server {

void FileState::Note(const absl::Status& status) {
  const absl::MutexLock lock(&mutex_);
  if (status.ok()) {
    fault_.reset();
    return;
  }
  const absl::Time begin = fault_ ? fault_->begin : absl::Now();
  fault_ = FileFault{flag_, std::string(status.message()), begin};
}

std::optional<FileFault> FileState::fault() const {
  const absl::MutexLock lock(&mutex_);
  return fault_;
}

}  // namespace graspdb::server
