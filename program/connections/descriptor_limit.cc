#include "program/connections/descriptor_limit.h"

#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"

namespace graspdb {
namespace {

// A server without connections has about 30 open.
constexpr rlim_t kMinDescriptors = 64;

// Numbers of descriptors are of type int.
constexpr rlim_t kMaxDescriptors = 1 << 30;

rlimit Limits() {
  rlimit limits{};
  getrlimit(RLIMIT_NOFILE, &limits);  // fails for wrong arguments only
  return limits;
}

}  // namespace

absl::Status RaiseDescriptorLimit() {
  rlimit limits = Limits();
  limits.rlim_cur = limits.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limits);  // if not, the limit stays as it is
  const rlim_t limit = Limits().rlim_cur;
  if (limit >= kMinDescriptors) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat("the limit of ", limit, " open files is too low; raise it to ", kMinDescriptors,
                   " or more (ulimit -n; LimitNOFILE of a unit)"));
}

int CountDescriptors() {
  std::error_code error;
  std::filesystem::directory_iterator open("/proc/self/fd", error);
  int count = -1;  // that of the folder itself
  for (const std::filesystem::directory_iterator end; !error && open != end;
       open.increment(error)) {
    ++count;
  }
  return std::max(count, 0);
}

int DescriptorLimit() { return static_cast<int>(std::min(Limits().rlim_cur, kMaxDescriptors)); }

}  // namespace graspdb
