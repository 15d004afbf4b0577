// graspdb-server.
#include <grpc/support/log.h>
#include <pthread.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <cstdio>
#include <string>

#include "server/log_field.h"
#include "server/options.h"
#include "server/server.h"
#include "server/version.h"

namespace graspdb::server {
namespace {

void StartLog(const std::string& level) {
  spdlog::set_default_logger(spdlog::stderr_logger_mt("graspdb"));
  spdlog::set_pattern("time=%Y-%m-%dT%H:%M:%S.%eZ level=%l %v", spdlog::pattern_time_type::utc);
  spdlog::set_level(spdlog::level::from_str(level));
  // gRPC's own messages are a mouthful on top of ours, which say what to do.
  gpr_set_log_function([](gpr_log_func_args* args) {
    spdlog::debug("event=grpc message={}", LogField(args->message));
  });
}

int Fail(const absl::Status& status) {
  std::fprintf(stderr, "graspdb-server: %s\n", std::string(status.message()).c_str());
  return absl::IsInvalidArgument(status) ? 2 : 1;
}

int Run(int argc, char** argv) {
  const ParsedOptions parsed = ParseOptions(argc, argv);
  if (parsed.done) return parsed.exit_status;
  const ServerOptions& options = parsed.options;

  // Blocked before any thread starts, so that only the wait below takes them.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);

  StartLog(options.log_level);
  absl::StatusOr<std::unique_ptr<Server>> server = Server::Start(options);
  if (!server.ok()) return Fail(server.status());
  spdlog::info("event=start version={} db={} listen={}", kVersion, LogField(options.database),
               (*server)->address());
  std::printf("listening on %s\n", (*server)->address().c_str());
  std::fflush(stdout);

  int signal = 0;
  sigwait(&signals, &signal);
  spdlog::info("event=drain signal={} seconds={}", signal, options.drain_s);
  (*server)->Drain();
  spdlog::info("event=stop");
  return 0;
}

}  // namespace
}  // namespace graspdb::server

int main(int argc, char** argv) { return graspdb::server::Run(argc, argv); }
