#include "lab/experiment/report/descriptor_section.h"

#include <algorithm>
#include <limits>
#include <set>

#include "absl/strings/str_cat.h"
#include "lab/experiment/report/markup.h"
#include "lab/experiment/report/plot.h"
#include "lab/experiment/report/report_markdown.h"

namespace graspdb::client {
namespace {

std::string Bars(const std::vector<DescriptorFigures>& figures) {
  std::set<std::string> objects;
  for (const DescriptorFigures& f : figures) {
    for (const auto& [object, share] : f.false_recognition) objects.insert(object);
  }
  BarChart chart{.title = "False recognition for each object and descriptor",
                 .unit = " %",
                 .categories = {objects.begin(), objects.end()},
                 .series = {}};
  std::set<std::string> drawn;
  for (const DescriptorFigures& f : figures) {
    if (!drawn.insert(f.descriptor).second) continue;
    BarSeries series{.name = absl::StrCat(f.descriptor, ", ", f.distance), .values = {}};
    for (const std::string& object : chart.categories) {
      const auto found = f.false_recognition.find(object);
      series.values.push_back(found == f.false_recognition.end()
                                  ? std::numeric_limits<double>::quiet_NaN()
                                  : 100 * found->second);
    }
    chart.series.push_back(std::move(series));
  }
  return absl::StrCat("<figure>", DrawBars(chart), "</figure>\n");
}

}  // namespace

std::string DescriptorSection(const std::vector<DescriptorFigures>& figures) {
  if (figures.empty()) return "";
  return absl::StrCat(
      "<section id=\"descriptors\">\n<h2>Descriptors</h2>\n<p>How often the nearest "
      "of the object's own views by the descriptor alone was taken from a side more than 15 "
      "degrees off (modulo symmetry), and how often the nearest of all views is another object's; ",
      figures.front().asked, " questions.</p>\n", HtmlTable(DescriptorTable(figures)),
      Bars(figures), "</section>\n");
}

}  // namespace graspdb::client
