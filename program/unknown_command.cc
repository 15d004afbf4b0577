#include "program/unknown_command.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

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

}  // namespace graspdb
