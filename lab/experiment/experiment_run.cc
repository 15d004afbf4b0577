#include "lab/experiment/experiment_run.h"

#include <atomic>
#include <mutex>
#include <thread>
#include <vector>

namespace graspdb::lab {

absl::Status ForEach(std::size_t count, const std::string& step, const ExperimentRun& run,
                     const std::function<absl::Status(std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;  // guards done, failure and the reports
  std::size_t done = 0;
  absl::Status failure;
  const auto loop = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      absl::Status status = run.cancelled && run.cancelled()
                                ? absl::CancelledError("stopped; nothing was written")
                                : work(i);
      const std::lock_guard lock(mutex);
      failure.Update(status);
      if (!failure.ok()) return;
      if (run.report) run.report(step, ++done, count);
    }
  };
  std::vector<std::thread> workers;
  for (int i = 1; i < run.workers; ++i) workers.emplace_back(loop);
  loop();
  for (std::thread& worker : workers) worker.join();
  return failure;
}

}  // namespace graspdb::lab
