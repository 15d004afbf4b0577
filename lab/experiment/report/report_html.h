// The experiment as a page to be read.
#pragma once

#include <string>
#include <vector>

#include "lab/experiment/descriptor_figures.h"
#include "lab/experiment/report/case_figures.h"

namespace graspdb::client {

// What the page is made of. `sections` are CaseSection()s, in the order of `rows`.
struct ReportPage {
  std::string command;  // as it could be typed again
  std::vector<CaseRow> rows;
  std::vector<std::string> sections;
  std::vector<DescriptorFigures> descriptors;
};

// One HTML file that needs no other: style and pictures are in it, scripts are not.
std::string ReportHtml(const ReportPage& page);

}  // namespace graspdb::client
