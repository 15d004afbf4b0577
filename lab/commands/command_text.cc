#include "lab/commands/command_text.h"

#include <algorithm>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"

namespace graspdb::lab {
namespace {

bool IsPlain(char c) {
  return absl::ascii_isalnum(static_cast<unsigned char>(c)) ||
         std::string("-_./,:=+@%").find(c) != std::string::npos;
}

std::string Quoted(const std::string& word) {
  if (!word.empty() && std::ranges::all_of(word, IsPlain)) return word;
  return absl::StrCat("'", absl::StrReplaceAll(word, {{"'", "'\\''"}}), "'");
}

}  // namespace

std::string CommandText(const CLI::App& command) {
  std::vector<std::string> words = {command.get_name()};
  for (const CLI::App* app = command.get_parent(); app != nullptr; app = app->get_parent()) {
    words.insert(words.begin(), app->get_name());
  }
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) continue;
    if (option->get_positional()) {
      for (const std::string& result : option->results()) words.push_back(Quoted(result));
      continue;
    }
    words.push_back(option->get_name());
    const bool takes_value = option->get_items_expected_max() > 0;
    if (takes_value) words.push_back(Quoted(absl::StrJoin(option->results(), ",")));
  }
  return absl::StrJoin(words, " ");
}

}  // namespace graspdb::lab
