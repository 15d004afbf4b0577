#include "server/base/background.h"

#include <sys/resource.h>
#include <unistd.h>

#include <exception>
#include <future>

#include "storage/changes/change_author.h"

namespace graspdb::server {
namespace {

// Increase of the niceness, which leaves a ninth of the weight; half of it would leave a third, and
// twice as much an eightieth, with which uploads would nearly stop under load.
constexpr int kNicer = 10;

}  // namespace

void LowerPriority() {
  // Linux keeps a niceness for each thread, caps it at 19, and always allows a higher one. The
  // server may have a niceness already.
  const auto thread = static_cast<id_t>(gettid());
  setpriority(PRIO_PROCESS, thread, getpriority(PRIO_PROCESS, thread) + kNicer);
}

absl::Status Guarded(absl::FunctionRef<absl::Status()> work) {
  try {
    return work();
  } catch (const std::exception& e) {
    return absl::InternalError(e.what());
  }
}

absl::Status InBackground(const std::function<absl::Status()>& work) {
  const auto quietly = [&, caller = storage::ChangeAuthor::Current()] {
    const storage::ChangeAuthor author(caller);
    LowerPriority();
    return work();
  };
  return std::async(std::launch::async, quietly).get();
}

}  // namespace graspdb::server
