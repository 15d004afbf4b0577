// The table of cases for a document.
#pragma once

#include <string>
#include <vector>

#include "lab/experiment/descriptor_comparison.h"
#include "lab/experiment/report/case_figures.h"

namespace graspdb::lab {

// The cells of the table of cases, first the headings, as they are shown; units and per cent signs
// are in the headings. "–": the case has no such queries.
std::vector<std::vector<std::string>> CaseTable(const std::vector<CaseRow>& rows);

// The same of descriptors and distances: how often the nearest of the object's own views was taken
// from a side more than 15 degrees off, and how often the nearest of all is another object's.
std::vector<std::vector<std::string>> DescriptorTable(
    const std::vector<DescriptorFigures>& figures);

// A table with its headings as GitHub Markdown.
std::string TableMarkdown(const std::vector<std::vector<std::string>>& table);

}  // namespace graspdb::lab
