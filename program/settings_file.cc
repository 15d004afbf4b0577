#include "program/settings_file.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <istream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace graspdb {
namespace {

std::string VariableName(const std::string& flag) {
  std::string name = "GRASPDB_";
  for (const char c : flag) {
    name += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return name;
}

// Empty when the variable is not set.
std::string Variable(const std::string& flag) {
  const char* value = std::getenv(VariableName(flag).c_str());
  return value == nullptr ? "" : value;
}

// CLI11 gives the file precedence over the variables; here variables override it.
class FileAfterVariables : public CLI::ConfigBase {
 public:
  explicit FileAfterVariables(std::vector<std::string> other_commands)
      : other_commands_(std::move(other_commands)) {}

  std::vector<CLI::ConfigItem> from_config(std::istream& in) const override {
    std::vector<CLI::ConfigItem> given = CLI::ConfigBase::from_config(in);
    std::erase_if(given, [this](const CLI::ConfigItem& item) {
      return !Variable(item.name).empty() || IsOfOtherCommand(item);
    });
    return given;
  }

 private:
  bool IsOfOtherCommand(const CLI::ConfigItem& item) const {
    const std::string& section = item.parents.empty() ? item.name : item.parents.front();
    return std::ranges::find(other_commands_, section) != other_commands_.end();
  }

  std::vector<std::string> other_commands_;
};

void NameVariables(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    if (option->get_lnames().empty()) continue;
    const std::string& flag = option->get_lnames().front();
    if (flag != "help" && flag != "version") option->envname(VariableName(flag));
  }
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    NameVariables(*command);
  }
}

}  // namespace

void AddSettingsFile(CLI::App& app, std::vector<std::string> other_commands) {
  const std::string path = Variable("config");
  app.set_config("--config", path, "File with settings, one KEY=VALUE per line", !path.empty());
  app.config_formatter(std::make_shared<FileAfterVariables>(std::move(other_commands)));
  app.allow_config_extras(CLI::config_extras_mode::error);
  NameVariables(app);
}

std::optional<int> ParseArguments(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  return std::nullopt;
}

}  // namespace graspdb
