#include "lab/experiment/report/markup.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"

namespace graspdb::client {

std::string EscapeMarkup(const std::string& text) {
  return absl::StrReplaceAll(
      text, {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}, {"'", "&#39;"}});
}

std::string HtmlTable(const std::vector<std::vector<std::string>>& table,
                      std::string (*section_of)(const std::string& cell)) {
  std::string out = "<div class=\"wide\"><table>\n";
  for (std::size_t row = 0; row < table.size(); ++row) {
    const char* tag = row == 0 ? "th" : "td";
    absl::StrAppend(&out, "<tr>");
    for (std::size_t column = 0; column < table[row].size(); ++column) {
      const std::string& cell = table[row][column];
      std::string content = EscapeMarkup(cell);
      if (section_of != nullptr && row > 0 && column == 0) {
        content = absl::StrCat("<a href=\"#", section_of(cell), "\">", content, "</a>");
      }
      absl::StrAppend(&out, "<", tag, ">", content, "</", tag, ">");
    }
    absl::StrAppend(&out, "</tr>\n");
  }
  return absl::StrCat(out, "</table></div>\n");
}

std::string Px(double length) {
  if (!std::isfinite(length)) return "0";
  const std::string text = absl::StrFormat("%.1f", length);
  if (text == "-0.0") return "0";
  return std::string(absl::StripSuffix(text, ".0"));
}

std::string Readable(double number) {
  if (number == 0 || !std::isfinite(number)) return number == 0 ? "0" : "–";
  const int digits = static_cast<int>(std::floor(std::log10(std::abs(number))));
  if (digits < -3 || digits > 5) return absl::StrFormat("%.2e", number);
  std::string text = absl::StrFormat("%.*f", std::max(0, 2 - digits), number);
  if (!absl::StrContains(text, '.')) return text;
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string SvgText(double x, double y, const std::string& anchor, const std::string& text) {
  return absl::StrCat("<text x=\"", Px(x), "\" y=\"", Px(y), "\" text-anchor=\"", anchor, "\">",
                      EscapeMarkup(text), "</text>\n");
}

std::string SvgFrame(double width, double height, const std::string& title,
                     const std::string& content) {
  return absl::StrCat(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" role=\"img\" width=\"", Px(width),
      "\" height=\"", Px(height), "\" viewBox=\"0 0 ", Px(width), " ", Px(height), "\">\n<title>",
      EscapeMarkup(title), "</title>\n", content, "</svg>\n");
}

double TextWidth(const std::string& text) { return 6.8 * static_cast<double>(text.size()); }

}  // namespace graspdb::client
