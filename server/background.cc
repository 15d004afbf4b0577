#include "server/background.h"

#include <sys/resource.h>
#include <unistd.h>

#include <future>

namespace graspdb::server {
namespace {

constexpr int kNiceness = 10;  // a ninth of the weight of a thread without it

}  // namespace

void GiveWay() {
  // Linux keeps a niceness for each thread. A higher one is never refused.
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNiceness);
}

absl::Status InBackground(const std::function<absl::Status()>& work) {
  const auto quietly = [&] {
    GiveWay();
    return work();
  };
  return std::async(std::launch::async, quietly).get();
}

}  // namespace graspdb::server
