#include "client/cli/base/command_line.h"

#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "client/sdk/security.h"
#include "program/client_flags.h"
#include "program/log/log.h"
#include "program/settings_file.h"
#include "program/text/printable_text.h"
#include "program/version.h"

namespace graspdb::client {
namespace {

enum ExitStatus { kDone = 0, kFailed = 1, kWrongUsage = 2, kNoServer = 3 };

// A server's own UNAVAILABLE, as of one whose disk failed, has details.
bool HasNoServer(const absl::Status& status) {
  return absl::IsUnavailable(status) && !status.GetPayload(kErrorDetails);
}

// Whether the command, or the client for the flags of the connection, has refused the command line;
// other INVALID_ARGUMENT errors are those of the server or of files.
bool IsWrongUsage(const absl::Status& status, const GlobalOptions& global) {
  if (HasWrongUsageMark(status)) return true;
  const absl::Status usage = CheckUsage({.server = global.server, .security = global.security});
  return !usage.ok() && status == usage;
}

// Its text may have names of files and of others' records. Some have several lines.
std::string LinesOf(const absl::Status& status) {
  const std::vector<std::string> lines = absl::StrSplit(status.message(), '\n');
  return absl::StrJoin(lines, "\n", [](std::string* out, const std::string& line) {
    out->append(PrintableText(line));
  });
}

int Execute(const GlobalOptions& global, const Action& action) {
  absl::Status status;
  try {
    status = action();
  } catch (const std::exception& e) {
    status = absl::InternalError(std::string("a library failed: ") + e.what());
  }
  if (status.ok()) return kDone;
  // The handshake's error does not name the file.
  if (absl::Status files = CheckSecurityFiles(global.security);
      HasNoServer(status) && !files.ok()) {
    status = files;
  }
  std::fprintf(stderr, "graspdb: %s\n", LinesOf(status).c_str());
  if (const std::string id = RequestIdOf(status); global.verbose && !id.empty()) {
    std::fprintf(stderr, "graspdb: request id %s\n", id.c_str());
  }
  if (IsWrongUsage(status, global)) return kWrongUsage;
  return HasNoServer(status) ? kNoServer : kFailed;
}

}  // namespace

void AddGlobalFlags(CLI::App& app, GlobalOptions* global) {
  app.set_version_flag("--version", absl::StrCat("graspdb ", kVersion));
  app.add_option("--server", global->server, "HOST:PORT of the server")->capture_default_str();
  app.add_option("--timeout", global->timeout_s, "Time limit of a call, seconds")
      ->check(CLI::Range(0.001, 86400.0))
      ->capture_default_str();
  AddBusyRetriesFlag(app, &global->busy_retries,
                     "How often a call is sent again while the server is busy, within --timeout");
  app.add_flag("--json", global->json, "Print results as JSON, one document per line");
  app.add_flag("--verbose", global->verbose,
               "Print the request id of a call that fails, which is in the server's log");
  AddSecurityFlags(app, &global->security);
}

int RunCommandLine(CLI::App& app, const GlobalOptions& global, const Action& action,
                   std::vector<std::string> other_commands, int argc, char** argv) {
  AddSettingsFile(app, std::move(other_commands));
  if (const std::optional<int> end = ParseArguments(app, argc, argv)) return *end;
  if (!action) {  // checked here, so that CLI11 names a command that it does not know
    std::fprintf(stderr, "A subcommand is required\nRun with --help for more information.\n");
    return kWrongUsage;
  }
  StartLog("graspdb", "warn");  // standard output is for results
  return Execute(global, action);
}

}  // namespace graspdb::client
