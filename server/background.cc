#include "server/background.h"

#include <sys/resource.h>
#include <unistd.h>

#include <future>

namespace graspdb::server {
namespace {

// Nicer than before by so much, which is a ninth of the weight; half of it would be a third, and
// twice as much an eightieth, with which uploads would all but stop under load.
constexpr int kNicer = 10;

}  // namespace

void LowerPriority() {
  // Linux keeps a niceness for each thread, caps it at 19, and never refuses a higher one. The
  // server may be nice itself.
  const auto thread = static_cast<id_t>(gettid());
  setpriority(PRIO_PROCESS, thread, getpriority(PRIO_PROCESS, thread) + kNicer);
}

absl::Status InBackground(const std::function<absl::Status()>& work) {
  const auto quietly = [&] {
    LowerPriority();
    return work();
  };
  return std::async(std::launch::async, quietly).get();
}

}  // namespace graspdb::server
