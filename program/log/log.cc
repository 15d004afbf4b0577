#include "program/log/log.h"

#include <grpc/support/log.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <utility>

#include "absl/synchronization/mutex.h"
#include "program/log/log_field.h"

namespace graspdb {

void StartLog(const std::string& program, const std::string& level) {
  // stderr_logger_mt() would throw at a second call.
  StartLog(
      std::make_shared<spdlog::logger>(program, std::make_shared<spdlog::sinks::stderr_sink_mt>()),
      level);
}

void StartLog(std::shared_ptr<spdlog::logger> logger, const std::string& level) {
  // Debian's Abseil aborts on a lock-order inversion even when nothing deadlocks. Tests keep that;
  // programs report it and continue.
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kReport);
  spdlog::set_default_logger(std::move(logger));
  spdlog::set_pattern("time=%Y-%m-%dT%H:%M:%S.%eZ level=%l %v", spdlog::pattern_time_type::utc);
  spdlog::set_level(spdlog::level::from_str(level));
  gpr_set_log_function([](gpr_log_func_args* args) {
    spdlog::debug("event=grpc message={}", LogField(args->message));
  });
}

}  // namespace graspdb
