// graspdb-console: a page to look at a server, and the gateway by which it calls it.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/cli/base/command.h"
#include "client/sdk/security.h"
#include "console/gateway.h"
#include "console/grpc_upstream.h"
#include "console/page_file.h"
#include "program/connections/descriptor_limit.h"
#include "program/standard_streams.h"
#include "program/stop_signal.h"

namespace graspdb::console {
namespace {

constexpr char kCommand[] = "console";

absl::Status Serve(const client::GlobalOptions& global, const GatewayOptions& options,
                   const StopSignal& stop) {
  const client::ConnectionOptions connection{.server = global.server, .security = global.security};
  for (const absl::Status& status : {CheckOptions(options), client::CheckOptions(connection)}) {
    if (absl::IsInvalidArgument(status)) return client::WrongUsage(status);
    if (!status.ok()) return status;
  }
  absl::StatusOr<std::unique_ptr<Gateway>> gateway =
      Gateway::Start(options, PageFiles(), std::make_unique<GrpcUpstream>(connection));
  if (!gateway.ok()) return absl::FailedPreconditionError(gateway.status().message());
  std::printf("console on %s\n", (*gateway)->url().c_str());
  if (!client::WriteOutput()) return absl::OkStatus();
  stop.Wait();
  return absl::OkStatus();
}

// The server has variables with the names of some of the flags.
void NameVariables(CLI::App* command) {
  for (CLI::Option* option : command->get_options()) {
    std::string name = option->get_lnames().front();
    if (name == "help") continue;
    std::ranges::replace(name, '-', '_');
    option->envname(absl::StrCat("GRASPDB_CONSOLE_", absl::AsciiStrToUpper(name)));
  }
}

void AddConsoleCommand(CLI::App& app, GatewayOptions* options) {
  CLI::App* command = client::AddCommand(
      app, kCommand, "Show scenes, answers and the catalogue of a server in a browser");
  command->add_option("--listen", options->listen, "HOST:PORT for browsers; port 0 picks one")
      ->capture_default_str();
  command->add_option("--tls-cert", options->tls_cert,
                      "File with the console's certificate chain (PEM), for TLS with browsers");
  command->add_option("--tls-key", options->tls_key,
                      "File with the private key of --tls-cert (PEM)");
  command->add_flag(
      "--behind-proxy", options->behind_proxy,
      "Listen without TLS: a proxy with TLS is in front, and only it reaches --listen");
  command->add_option("--host", options->hosts,
                      "Another name by which browsers open the console, as in their address bar: "
                      "NAME or NAME:PORT; may be repeated");
  NameVariables(command);
}

// `graspdb` passes on the command; started by itself, this program has one command only.
std::vector<char*> WithCommand(int argc, char** argv) {
  static char command[] = "console";
  std::vector<char*> out(argv, argv + argc);
  bool is_there = false;
  for (const char* argument : out) is_there = is_there || std::string_view(argument) == kCommand;
  if (!is_there && !out.empty()) out.insert(out.begin() + 1, command);
  out.push_back(nullptr);
  return out;
}

int Run(int argc, char** argv) {
  const StopSignal stop;
  if (const absl::Status limit = RaiseDescriptorLimit(); !limit.ok()) {
    std::fprintf(stderr, "graspdb: %s\n", std::string(limit.message()).c_str());
    return 1;
  }
  CLI::App app("graspdb-console shows a server in a browser.", "graspdb");
  client::GlobalOptions global;
  GatewayOptions options;
  client::AddGlobalFlags(app, &global);
  AddConsoleCommand(app, &options);
  std::vector<char*> arguments = WithCommand(argc, argv);
  client::Action action = [&] { return Serve(global, options, stop); };
  return client::RunCommandLine(
      app, global, action,
      {"import", "teach", "recognize", "replay", "describe", "export", "objects", "grasps", "cells",
       "status", "sensors", "backup", "uploads", "watch", "doctor", "bench", "robot", "simulate",
       "eval"},
      static_cast<int>(arguments.size()) - 1, arguments.data());
}

}  // namespace
}  // namespace graspdb::console

int main(int argc, char** argv) {
  graspdb::OpenStandardStreams();
  return graspdb::WithOutputWritten("graspdb", graspdb::console::Run(argc, argv));
}
