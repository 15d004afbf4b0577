#include "lab/experiment/report/report_html.h"

#include "absl/strings/str_cat.h"
#include "lab/experiment/report/case_section.h"
#include "lab/experiment/report/descriptor_section.h"
#include "lab/experiment/report/markup.h"
#include "lab/experiment/report/page_style.h"
#include "lab/experiment/report/report_markdown.h"

namespace graspdb::client {
namespace {

constexpr char kWords[] =
    "<p>A depth camera, real or simulated, sees objects on a table; each answer is held against "
    "where the object truly is. <b>Object</b>: the right one is named. <b>Pose</b>: ADD-S is under "
    "5 % of the "
    "diameter. <b>Strictly</b>: no point is farther off than 8 mm, or 6 % of the diameter. "
    "<b>Turn</b> and <b>shift</b> are mean errors of the right poses, modulo symmetry. Shares are "
    "of "
    "the questions about objects that were taught; <b>unknown rejected</b> is of the others. The "
    "scenes of a case run side by side, so that times are those of a busy machine.</p>\n";

}  // namespace

std::string ReportHtml(const ReportPage& page) {
  std::string out = absl::StrCat(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>graspdb eval</title>\n<style>\n",
      PageStyle(), "</style>\n</head>\n<body>\n<h1>How often the answer is right</h1>\n<pre><code>",
      EscapeMarkup(page.command), "</code></pre>\n", kWords);
  absl::StrAppend(&out, page.rows.empty() ? "<p>No case has ended yet.</p>\n"
                                          : HtmlTable(CaseTable(page.rows), SectionId));
  absl::StrAppend(&out, DescriptorSection(page.descriptors));
  for (const std::string& section : page.sections) absl::StrAppend(&out, section);
  return absl::StrCat(out, "</body>\n</html>\n");
}

}  // namespace graspdb::client
