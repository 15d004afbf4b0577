#include "client/cli/lab_program.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "client/cli/base/beside_program.h"

namespace graspdb::client {
namespace {

constexpr char kProgram[] = "graspdb-lab";

struct LabCommand {
  std::string_view name;
  std::string_view description;
};

constexpr std::array<LabCommand, 4> kCommands = {{
    {"bench", "Measure a server's latency and throughput"},
    {"robot", "Run a simulated robot that picks objects seen by a simulated camera"},
    {"simulate", "Take captures with a simulated depth camera"},
    {"eval", "Measure recognition rates and pose errors on simulated and real frames"},
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

std::vector<std::string> LabCommands() {
  std::vector<std::string> out;
  out.reserve(kCommands.size());
  for (const LabCommand& command : kCommands) out.emplace_back(command.name);
  return out;
}

void AddLabCommands(CLI::App& app) {
  for (const LabCommand& command : kCommands) {
    app.add_subcommand(std::string(command.name), std::string(command.description));
  }
}

void RunLabCommand(const CLI::App& app, int argc, char** argv) {
  const std::string_view name = CommandOf(app, argc, argv);
  const auto is_named = [name](const LabCommand& command) { return command.name == name; };
  if (std::ranges::none_of(kCommands, is_named)) return;
  const absl::Status failed = BecomeProgram(kProgram, {argv + 1, argv + argc});
  std::fprintf(stderr, "graspdb: '%s' %s\n", std::string(name).c_str(),
               std::string(failed.message()).c_str());
  std::exit(1);
}

}  // namespace graspdb::client
