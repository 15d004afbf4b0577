// Pieces of HTML and SVG.
#pragma once

#include <string>
#include <vector>

namespace graspdb::client {

// `text` as content or as an attribute's value between double quotes.
std::string EscapeMarkup(const std::string& text);

// A <table> of texts, the first row headings; with `section_of` the first cell of every other row
// is a link to the section of that id.
std::string HtmlTable(const std::vector<std::vector<std::string>>& table,
                      std::string (*section_of)(const std::string& cell) = nullptr);

// A length in an SVG: at most one decimal, none where it is 0. 0 for what is not finite.
std::string Px(double length);

// A number as it is read: "%.3g", but never with an exponent between 0.001 and 100000.
std::string Readable(double number);

// <text> with its place, an anchor (start, middle, end) and the text, which is escaped.
std::string SvgText(double x, double y, const std::string& anchor, const std::string& text);

// An <svg> of that size around `content`, with a title that is escaped.
std::string SvgFrame(double width, double height, const std::string& title,
                     const std::string& content);

// How wide a text is drawn in a plot, about, px.
double TextWidth(const std::string& text);

}  // namespace graspdb::client
