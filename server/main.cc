// graspdb-server.
#include <spdlog/spdlog.h>

#include <csignal>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "program/connections/descriptor_limit.h"
#include "program/health_command.h"
#include "program/log/background_log.h"
#include "program/log/log_field.h"
#include "program/standard_streams.h"
#include "program/stop_signal.h"
#include "program/version.h"
#include "server/access/token_command.h"
#include "server/backups/backup_program.h"
#include "server/base/options.h"
#include "server/server.h"

namespace graspdb::server {
namespace {

int Fail(const absl::Status& status) {
  std::fprintf(stderr, "graspdb-server: %s\n", std::string(status.message()).c_str());
  return absl::IsInvalidArgument(status) ? 2 : 1;
}

// The exit status of a command; nothing if a server is to be started.
std::optional<int> RunCommand(int argc, char** argv) {
  const std::string_view command = argc > 1 ? argv[1] : "";
  if (command == "backup") return RunBackupProgram(argc, argv);
  if (command == "token") return RunTokenCommand(argc - 1, argv + 1);
  if (command == "health") {
    return RunHealthCommand("graspdb-server", "127.0.0.1:50051", argc - 1, argv + 1);
  }
  return std::nullopt;
}

int Run(int argc, char** argv) {
  if (const std::optional<int> end = RunCommand(argc, argv)) {
    return WithOutputWritten("graspdb-server", *end);
  }
  const ParsedOptions parsed = ParseOptions(argc, argv);
  if (parsed.done) return WithOutputWritten("graspdb-server", parsed.exit_status);
  const ServerOptions& options = parsed.options;
  if (const absl::Status limit = RaiseDescriptorLimit(); !limit.ok()) return Fail(limit);

  // A file that reaches its limit is an error of that write, not the end of the server.
  std::signal(SIGXFSZ, SIG_IGN);
  const StopSignal stop;
  StartBackgroundLog("graspdb", options.log_level);
  if (options.index == "flann") {
    spdlog::warn(
        "event=option_without_effect option=--index advice=\"remove it: searches are exact\"");
  }
  absl::StatusOr<std::unique_ptr<Server>> server =
      Server::Start(options, [&stop] { return stop.IsPending(); });
  if (absl::IsCancelled(server.status())) {
    spdlog::info("event=start_cancelled signal={}", stop.Wait());
    return 0;
  }
  if (!server.ok()) return Fail(server.status());
  spdlog::info("event=start version={} db={} listen={}", kVersion, LogField(options.database),
               (*server)->address());
  if (const std::string metrics = (*server)->metrics_address(); !metrics.empty()) {
    std::printf("metrics on http://%s/metrics\n", metrics.c_str());
  }
  std::printf("listening on %s\n", (*server)->address().c_str());
  std::fflush(stdout);

  const int signal = stop.Wait();
  spdlog::info("event=drain signal={} seconds={}", signal, options.drain_s);
  (*server)->Drain();
  spdlog::info("event=stop");
  return 0;
}

}  // namespace
}  // namespace graspdb::server

int main(int argc, char** argv) {
  graspdb::OpenStandardStreams();
  return graspdb::server::Run(argc, argv);
}
