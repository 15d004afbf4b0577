#include "client/cli/base/progress_line.h"

#include <unistd.h>

#include <cstdint>
#include <iostream>
#include <utility>

namespace graspdb::client {
namespace {

constexpr int kBarWidth = 40;

int PartOf(int done, int total, int parts) {
  return total > 0 ? static_cast<int>(std::int64_t{done} * parts / total) : parts;
}

}  // namespace

ProgressLine::ProgressLine(std::string unit)
    : unit_(std::move(unit)), is_terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (is_terminal_ && last_ >= 0) std::cerr << "\n";
}

void ProgressLine::Report(int done, int total) {
  const int now = PartOf(done, total, is_terminal_ ? 100 : 4);
  if (now == last_ || (!is_terminal_ && now == 0)) return;
  last_ = now;
  if (is_terminal_) {
    const auto full = static_cast<std::size_t>(PartOf(done, total, kBarWidth));
    std::cerr << "\r[" << std::string(full, '#') << std::string(kBarWidth - full, ' ') << "] "
              << done << "/" << total << std::flush;
  } else {
    std::cerr << done << " of " << total << " " << unit_ << "\n";
  }
}

}  // namespace graspdb::client
