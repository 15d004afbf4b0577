#include "rendering/meshes/stated_unit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/string_view.h"
#include "rendering/meshes/length_unit.h"

namespace graspdb::rendering {
namespace {

// Of a line; longer ones are data.
constexpr std::size_t kMaxCharacters = 200;

struct Word {
  std::string text;
  bool is_value = false;  // behind ":" or "="
};

// Of letters, digits and points, in lower case; other characters separate words.
std::vector<Word> WordsOf(std::string_view line) {
  std::vector<Word> words(1);
  for (const char c : line) {
    const auto byte = static_cast<unsigned char>(c);
    if (absl::ascii_isalnum(byte) || c == '.') {
      words.back().text += absl::ascii_tolower(byte);
      continue;
    }
    if (!words.back().text.empty()) words.emplace_back();
    words.back().is_value = words.back().is_value || c == ':' || c == '=';
  }
  for (Word& word : words) {
    while (word.text.ends_with('.')) word.text.pop_back();  // the end of a sentence
  }
  if (words.back().text.empty()) words.pop_back();
  return words;
}

std::optional<double> UnitNamed(const std::string& word) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 16> kOtherNames = {
      {{"millimeter", "mm"},
       {"millimeters", "mm"},
       {"millimetre", "mm"},
       {"millimetres", "mm"},
       {"centimeter", "cm"},
       {"centimeters", "cm"},
       {"centimetre", "cm"},
       {"centimetres", "cm"},
       {"meter", "m"},
       {"meters", "m"},
       {"metre", "m"},
       {"metres", "m"},
       {"in", "inch"},
       {"inches", "inch"},
       {"mms", "mm"},
       {"cms", "cm"}}};
  const auto* other = std::ranges::find(kOtherNames, std::string_view(word),
                                        &std::pair<std::string_view, std::string_view>::first);
  const std::string_view name = other == kOtherNames.end() ? std::string_view(word) : other->second;
  const auto* unit = std::ranges::find(kLengthUnits, name, &LengthUnit::name);
  return unit == kLengthUnits.end() ? std::nullopt : std::optional(unit->metres);
}

// Words between "unit" and its length.
bool IsBetween(const std::string& word) {
  constexpr std::array<std::string_view, 7> kBetween = {"is",     "are",     "of",         "the",
                                                        "length", "measure", "measurement"};
  return std::ranges::find(kBetween, std::string_view(word)) != kBetween.end();
}

// Whether the length of a unit stands behind the word at `i`.
bool IsUnitAt(const std::vector<Word>& words, std::size_t i, UnitText text) {
  if (words[i].text == "units") return true;
  return words[i].text == "unit" && (text == UnitText::kComment || words[i + 1].is_value);
}

}  // namespace

std::optional<double> StatedUnit(std::string_view line, UnitText text) {
  if (line.size() > kMaxCharacters) {
    line = line.substr(0, kMaxCharacters);
    line = line.substr(0, line.find_last_of(' '));  // no part of a word
  }
  const std::vector<Word> words = WordsOf(line);
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (!IsUnitAt(words, i, text)) continue;
    std::size_t at = i + 1;
    while (at + 1 < words.size() && IsBetween(words[at].text)) ++at;
    // "units in mm", but "unit: in".
    if (at + 1 < words.size() && words[at].text == "in" && UnitNamed(words[at + 1].text)) ++at;
    double count = 0;
    if (at + 1 < words.size() && absl::SimpleAtod(words[at].text, &count)) {
      ++at;
    } else {
      count = 1;
    }
    // Else the word: "units in use".
    const bool is_in = words[at].text == "in";
    if (is_in && at + 1 < words.size() && !words[at].is_value) continue;
    const std::optional<double> unit_m = UnitNamed(words[at].text);
    if (unit_m && count > 0 && std::isfinite(count)) return count * *unit_m;
  }
  return std::nullopt;
}

}  // namespace graspdb::rendering
