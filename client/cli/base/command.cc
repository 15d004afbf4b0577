#include "client/cli/base/command.h"

#include <google/protobuf/util/json_util.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "absl/strings/cord.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "base/status_macros.h"
#include "client/sdk/security.h"
#include "files/base/json_object.h"
#include "program/client_flags.h"
#include "program/log/log.h"
#include "program/settings_file.h"
#include "program/standard_streams.h"
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

constexpr char kWrongUsageMark[] = "graspdb/wrong-usage";

std::atomic<bool> interrupted = false;

extern "C" void OnInterrupt(int /*signal*/) { interrupted.store(true); }

}  // namespace

Client Connect(const GlobalOptions& options) {
  return Client({.server = options.server,
                 .timeout = absl::Seconds(options.timeout_s),
                 .busy_retries = options.busy_retries,
                 .security = options.security});
}

CLI::App* AddCommand(CLI::App& parent, const std::string& name, const std::string& description) {
  CLI::App* command = parent.add_subcommand(name, description);
  command->fallthrough();
  return command;
}

CLI::Validator WholeNumberFrom(std::int64_t least) {
  const auto error = [least](const std::string& text) -> std::string {
    std::int64_t number = 0;
    if (absl::SimpleAtoi(text, &number) && number >= least) return "";
    return absl::StrCat("give a whole number of ", least, " or more, not ", text);
  };
  return {error, absl::StrCat(">= ", least)};
}

absl::StatusOr<std::string> ToJson(const google::protobuf::Message& message) {
  std::string text;
  const auto status = google::protobuf::util::MessageToJsonString(message, &text);
  if (!status.ok()) return absl::InternalError(absl::StrCat("no JSON: ", status.ToString()));
  return text;
}

absl::StatusOr<google::protobuf::Struct> ToDocument(const google::protobuf::Message& message) {
  ASSIGN_OR_RETURN(const std::string text, ToJson(message));
  google::protobuf::Struct out;
  const auto status = google::protobuf::util::JsonStringToMessage(text, &out);
  if (!status.ok()) return absl::InternalError(absl::StrCat("no JSON: ", status.ToString()));
  return out;
}

absl::Status PrintJson(const google::protobuf::Message& message) {
  ASSIGN_OR_RETURN(std::string text, ToJson(message));
  std::printf("%s\n", text.c_str());
  return absl::OkStatus();
}

absl::Status PrintJson(const google::protobuf::Struct& document) {
  ASSIGN_OR_RETURN(const std::string text,
                   files::PrintDocument(document, files::JsonLayout::kOneLine));
  std::printf("%s\n", text.c_str());
  return absl::OkStatus();
}

bool WriteOutput() { return FlushOutput().ok(); }

absl::Status WrongUsage(absl::Status status) {
  status.SetPayload(kWrongUsageMark, absl::Cord());
  return status;
}

bool HasWrongUsageMark(const absl::Status& status) {
  return status.GetPayload(kWrongUsageMark).has_value();
}

absl::Status WithMessage(const absl::Status& status, const std::string& message) {
  absl::Status out(status.code(), message);
  status.ForEachPayload([&](absl::string_view type_url, const absl::Cord& payload) {
    out.SetPayload(type_url, payload);
  });
  return out;
}

bool Interrupted() {
  static const bool watching = [] {
    struct sigaction action {};
    action.sa_handler = OnInterrupt;
    action.sa_flags = static_cast<int>(SA_RESETHAND);  // the second Ctrl-C ends the process
    sigaction(SIGINT, &action, nullptr);
    return true;
  }();
  return watching && interrupted.load();
}

absl::Status BecomeProgram(const std::string& program, std::vector<std::string> arguments) {
  std::error_code error;
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string path = here.parent_path() / program;
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  execv(path.c_str(), argv.data());
  return absl::FailedPreconditionError(absl::StrCat("needs the program ", path,
                                                    ", which does not start (",
                                                    std::strerror(errno), "): install it"));
}

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
