#include "client/cli/other_programs.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "client/cli/base/beside_program.h"

namespace graspdb::client {
namespace {

constexpr char kLab[] = "graspdb-lab";
constexpr char kConsole[] = "graspdb-console";

struct OtherCommand {
  std::string_view name;
  std::string_view description;
  const char* program;
};

constexpr std::array<OtherCommand, 5> kCommands = {{
    {"bench", "Measure a server's latency and throughput", kLab},
    {"robot", "Run a simulated robot that picks objects seen by a simulated camera", kLab},
    {"simulate", "Take captures with a simulated depth camera", kLab},
    {"eval", "Measure recognition rates and pose errors on simulated and real frames", kLab},
    {"console", "Show scenes, answers and the catalogue of a server in a browser", kConsole},
}};

// The first argument that is neither a flag nor a flag's value; empty without one.
std::string_view CommandOf(const CLI::App& app, int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (!argument.starts_with('-')) return argv[i];
    const CLI::Option* flag = app.get_option_no_throw(argument);
    const bool takes_value =
        flag != nullptr && flag->get_expected_max() > 0 && flag->get_type_size() > 0;
    if (takes_value || argument == "--config") ++i;  // which AddSettingsFile() adds later
  }
  return {};
}

}  // namespace

std::vector<std::string> OtherCommands() {
  std::vector<std::string> out;
  out.reserve(kCommands.size());
  for (const OtherCommand& command : kCommands) out.emplace_back(command.name);
  return out;
}

void AddOtherCommands(CLI::App& app) {
  for (const OtherCommand& command : kCommands) {
    app.add_subcommand(std::string(command.name), std::string(command.description));
  }
}

void RunOtherCommand(const CLI::App& app, int argc, char** argv) {
  const std::string_view name = CommandOf(app, argc, argv);
  const auto* command = std::ranges::find(kCommands, name, &OtherCommand::name);
  if (command == kCommands.end()) return;
  const absl::Status failed = BecomeProgram(command->program, {argv + 1, argv + argc});
  std::fprintf(stderr, "graspdb: '%s' %s\n", std::string(name).c_str(),
               std::string(failed.message()).c_str());
  std::exit(1);
}

}  // namespace graspdb::client
