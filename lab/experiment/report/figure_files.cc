#include "lab/experiment/report/figure_files.h"

#include <map>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "lab/experiment/report/page_style.h"

namespace graspdb::client {
namespace {

constexpr char kBegin[] = "<svg ";
constexpr char kEnd[] = "</svg>";
constexpr std::size_t kLongestName = 80;

// The text between two others; empty where they are not there.
std::string Between(const std::string& text, const std::string& before, const std::string& after) {
  const std::size_t begin = text.find(before);
  if (begin == std::string::npos) return "";
  const std::size_t from = begin + before.size();
  return text.substr(from, text.find(after, from) - from);
}

// Small letters and digits, with dashes for all between them.
std::string Slug(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (absl::ascii_isalnum(static_cast<unsigned char>(c))) {
      out += absl::ascii_tolower(static_cast<unsigned char>(c));
    } else if (!out.empty() && out.back() != '-') {
      out += '-';
    }
  }
  out = out.substr(0, kLongestName);
  while (!out.empty() && out.back() == '-') out.pop_back();
  return out;
}

std::string WithStyle(const std::string& svg) {
  const std::size_t end_of_tag = svg.find('>') + 1;
  return absl::StrCat(svg.substr(0, end_of_tag), "\n<style>\n", PlotFileStyle(), "</style>",
                      svg.substr(end_of_tag), "\n");
}

}  // namespace

std::vector<FigureFile> FigureFiles(const std::string& section, const std::string& markup) {
  std::vector<FigureFile> out;
  std::map<std::string, int> seen;
  for (std::size_t begin = markup.find(kBegin); begin != std::string::npos;) {
    const std::size_t end = markup.find(kEnd, begin) + sizeof(kEnd) - 1;
    const std::string svg = markup.substr(begin, end - begin);
    std::string name = Slug(absl::StrCat(section, " ", Between(svg, "<title>", "</title>")));
    if (const int number = ++seen[name]; number > 1) absl::StrAppend(&name, "-", number);
    out.push_back({name + ".svg", WithStyle(svg)});
    begin = markup.find(kBegin, end);
  }
  return out;
}

}  // namespace graspdb::client
