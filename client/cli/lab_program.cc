#include "client/cli/lab_program.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

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
    if (flag != nullptr && flag->get_expected_max() > 0 && flag->get_type_size() > 0) ++i;
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
  std::error_code error;
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program = here.parent_path() / kProgram;
  execv(program.c_str(), argv);
  std::fprintf(stderr,
               "graspdb: '%s' needs the program %s, which does not start (%s): install it\n",
               std::string(name).c_str(), program.c_str(), std::strerror(errno));
  std::exit(1);
}

}  // namespace graspdb::client
