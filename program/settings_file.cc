#include "program/settings_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <istream>
#include <iterator>
#include <memory>
#include <numeric>
#include <sstream>
#include <string_view>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "program/text/text_encoding.h"

namespace graspdb {
namespace {

// Letters to insert, remove or replace that are taken for a slip. Three would make "list" of
// "grab".
constexpr std::size_t kMaxSlip = 2;

// Levenshtein's distance.
std::size_t DistanceOf(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = a[i] == b[j] ? diagonal : diagonal + 1;
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

// The nearest name; empty if all are farther than a slip.
std::string NearestOf(const std::vector<const CLI::App*>& commands, const std::string& word) {
  std::string out;
  std::size_t least = std::min(kMaxSlip + 1, word.size());
  for (const CLI::App* command : commands) {
    const std::size_t distance = DistanceOf(command->get_name(), word);
    if (distance >= least) continue;
    least = distance;
    out = command->get_name();
  }
  return out;
}

std::string VariableName(const std::string& flag) {
  std::string name = "GRASPDB_";
  for (const char c : flag) {
    name += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return name;
}

// The command with the section of `item`; null without one.
const CLI::App* CommandOf(const CLI::App& app, const CLI::ConfigItem& item) {
  const CLI::App* command = &app;
  for (const std::string& parent : item.parents) {
    const auto found = command->get_subcommands(
        [&](const CLI::App* other) { return other->get_name() == parent; });
    if (found.empty()) return nullptr;
    command = found.front();
  }
  return command;
}

// Null without one.
const CLI::Option* OptionOf(const CLI::App& app, const CLI::ConfigItem& item) {
  const CLI::App* command = CommandOf(app, item);
  if (command == nullptr) return nullptr;
  for (const std::string& name : {"--" + item.name, "-" + item.name, item.name}) {
    if (const CLI::Option* option = command->get_option_no_throw(name)) return option;
  }
  return nullptr;
}

bool HasVariable(const CLI::App& app, const CLI::ConfigItem& item) {
  const CLI::Option* option = OptionOf(app, item);
  const char* value = option == nullptr ? nullptr : std::getenv(option->get_envname().c_str());
  return value != nullptr && *value != '\0';
}

bool HasSetting(const CLI::App& app, const CLI::ConfigItem& item) {
  const bool is_section = item.name == "++" || item.name == "--";  // its begin and end
  return is_section ? CommandOf(app, item) != nullptr : OptionOf(app, item) != nullptr;
}

std::string FileOf(const CLI::App& app) {
  const auto files = app.get_config_ptr()->as<std::vector<std::string>>();
  return files.empty() ? "--config" : files.front();
}

// CLI11's own error has neither the file nor what is wrong.
void CheckSetting(const CLI::App& app, const CLI::ConfigItem& item) {
  if (HasSetting(app, item)) return;
  const bool is_section = item.name == "++" || item.name == "--";
  const std::string name = is_section ? "section [" + CLI::detail::join(item.parents, ".") + "]"
                                      : "setting " + item.fullname();
  throw CLI::ConfigError(FileOf(app) + ": there is no " + name +
                         "; settings are flags without dashes, sections are commands; a setting "
                         "is one line, a list too: KEY=[\"A\",\"B\"]");
}

// CLI11 takes the lines that follow, sections included, for the rest of a list without its end.
void CheckLists(const CLI::App& app, const std::string& text) {
  int number = 0;
  for (absl::string_view line : absl::StrSplit(text, '\n')) {
    ++number;
    line = absl::StripAsciiWhitespace(line);
    const std::size_t equals = line.find('=');
    if (equals == absl::string_view::npos || line.front() == '#' || line.front() == ';') continue;
    const absl::string_view rest = line.substr(equals + 1);
    const absl::string_view value = absl::StripAsciiWhitespace(rest.substr(0, rest.find('#')));
    if (!absl::StartsWith(value, "[") || absl::EndsWith(value, "]")) continue;
    throw CLI::ConfigError(
        absl::StrCat(FileOf(app), ", line ", number, ": the list of ",
                     absl::StripAsciiWhitespace(line.substr(0, equals)),
                     " has no ] at its end; give one line, KEY=[\"A\",\"B\"] without #, "
                     "and quotes around another value that begins with ["));
  }
}

// CLI11 gives the file precedence over the variables; here variables override it.
class FileAfterVariables : public CLI::ConfigBase {
 public:
  FileAfterVariables(const CLI::App& app, std::vector<std::string> other_commands)
      : app_(app), other_commands_(std::move(other_commands)) {}

  std::vector<CLI::ConfigItem> from_config(std::istream& in) const override {
    std::string text(std::istreambuf_iterator<char>(in), {});
    if (absl::Status taken = TakeUtf8(FileOf(app_), &text); !taken.ok()) {
      throw CLI::ConfigError(std::string(taken.message()));
    }
    CheckLists(app_, text);
    std::istringstream lines(text);
    std::vector<CLI::ConfigItem> given = CLI::ConfigBase::from_config(lines);
    std::erase_if(given, [this](const CLI::ConfigItem& item) {
      return HasVariable(app_, item) || IsOfOtherCommand(item);
    });
    for (const CLI::ConfigItem& item : given) CheckSetting(app_, item);
    return given;
  }

 private:
  bool IsOfOtherCommand(const CLI::ConfigItem& item) const {
    const std::string& section = item.parents.empty() ? item.name : item.parents.front();
    return std::ranges::find(other_commands_, section) != other_commands_.end();
  }

  const CLI::App& app_;
  std::vector<std::string> other_commands_;
};

void NameVariables(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    if (option->get_lnames().empty()) continue;
    const std::string& flag = option->get_lnames().front();
    if (flag == "help" || flag == "version" || !option->get_envname().empty()) continue;
    option->envname(VariableName(flag));
  }
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    NameVariables(*command);
  }
}

// The error of a value that is no number; empty without one. CLI11's ranges accept NaN, since it is
// neither below nor above them.
std::string NotANumberError(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_type_name().find("FLOAT") == std::string::npos) continue;
    for (const std::string& value : option->results()) {
      double number = 0;
      if (absl::SimpleAtod(value, &number) && std::isnan(number)) {
        return option->get_name() + ": give a number, not " + value;
      }
    }
  }
  for (const CLI::App* command : app.get_subcommands()) {  // those that were given
    if (std::string error = NotANumberError(*command); !error.empty()) return error;
  }
  return "";
}

bool IsQuoted(const std::string& value) {
  return value.size() >= 2 && value.front() == value.back() &&
         (value.front() == '"' || value.front() == '\'');
}

// The error of a value that a shell would have changed; empty without one: the home folder, which
// is expanded neither behind = nor in variables, and quotes, which Docker's --env-file keeps.
std::string NoShellError(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    const char* variable = std::getenv(option->get_envname().c_str());
    for (const std::string& value : option->results()) {
      if (value == "~" || value.starts_with("~/")) {
        return absl::StrCat(option->get_name(), ": ", value,
                            " begins with ~, which stands for the home folder in a shell only; "
                            "write the whole path");
      }
      if (variable != nullptr && value == variable && IsQuoted(value)) {
        return absl::StrCat("the value of ", option->get_envname(),
                            " has quotes around it, which are part of it outside of a shell; "
                            "leave them out");
      }
    }
  }
  for (const CLI::App* command : app.get_subcommands()) {  // those that were given
    if (std::string error = NoShellError(*command); !error.empty()) return error;
  }
  return "";
}

// Of `app`, or of one of its commands that were given.
bool HasFlag(const CLI::App& app, const std::string& name) {
  const auto has_flag = [&name](const CLI::App* command) { return HasFlag(*command, name); };
  return app.get_option_no_throw(name) != nullptr ||
         std::ranges::any_of(app.get_subcommands(), has_flag);
}

// The error of a flag of `all` that was taken for the value of the one before in `app`; empty
// without one. CLI11 takes the next word, whatever it is.
std::string FlagAsValueError(const CLI::App& all, const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_lnames().empty()) continue;  // after --, anything is a value
    for (const std::string& value : option->results()) {
      const std::string flag = value.substr(0, value.find('='));
      if (flag.starts_with("--") && HasFlag(all, flag)) {
        return option->get_name() + ": give a value, not the flag " + flag;
      }
    }
  }
  for (const CLI::App* command : app.get_subcommands()) {  // those that were given
    if (std::string error = FlagAsValueError(all, *command); !error.empty()) return error;
  }
  return "";
}

// The error of a word such as `--health=`; empty without one. CLI11 takes the next word for its
// value.
std::string NoValueError(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--") break;
    if (!word.starts_with("--") || word.find('=') != word.size() - 1) continue;
    const std::string flag(word.substr(0, word.size() - 1));
    return absl::StrCat(flag, "= has no value; give one, or ", flag, " \"\" for an empty one");
  }
  return "";
}

int WrongUsage(const std::string& error) {
  std::fprintf(stderr, "%s\nRun with --help for more information.\n", error.c_str());
  return 2;
}

}  // namespace

std::string UnknownCommandError(const CLI::App& app) {
  const CLI::App* command = &app;
  std::string path = app.get_name();
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    path += " " + command->get_name();
  }
  const auto commands = command->get_subcommands([](const CLI::App* /*any*/) { return true; });
  const std::vector<std::string> words = app.remaining(/*recurse=*/true);
  if (commands.empty() || words.empty() || words.front().starts_with('-')) return "";
  const std::string nearest = NearestOf(commands, words.front());
  return "there is no command " + words.front() +
         (nearest.empty() ? "" : "; the nearest one is " + nearest) + "; see " + path + " --help";
}

void AddSettingsFile(CLI::App& app, std::vector<std::string> other_commands) {
  const char* variable = std::getenv("GRASPDB_CONFIG");
  const std::string path = variable == nullptr ? "" : variable;
  app.set_config("--config", path, "File with settings, one KEY=VALUE per line", !path.empty());
  app.config_formatter(std::make_shared<FileAfterVariables>(app, std::move(other_commands)));
  app.allow_config_extras(CLI::config_extras_mode::error);
  NameVariables(app);
}

std::optional<int> ParseArguments(CLI::App& app, int argc, char** argv) {
  std::string error = NoValueError(argc, argv);
  if (!error.empty()) return WrongUsage(error);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    const bool is_help = e.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success);
    if (is_help) return app.exit(e) == 0 ? 0 : 2;
    error = FlagAsValueError(app, app);
    if (!error.empty()) return WrongUsage(error);
    const std::string unknown = UnknownCommandError(app);
    if (unknown.empty()) return app.exit(e) == 0 ? 0 : 2;
    std::fprintf(stderr, "%s\n", unknown.c_str());
    return 2;
  }
  error = FlagAsValueError(app, app);
  if (error.empty()) error = NotANumberError(app);
  if (error.empty()) error = NoShellError(app);
  if (error.empty()) return std::nullopt;
  return WrongUsage(error);
}

}  // namespace graspdb
