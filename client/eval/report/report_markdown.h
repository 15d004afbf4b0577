// The table of cases for a document.
#pragma once

#include <string>
#include <vector>

#include "client/eval/report/case_figures.h"

namespace graspdb::client {

// The cells of the table of cases, first the headings, as they are shown; units and per cent signs
// are in the headings. What a case did not ask has "–".
std::vector<std::vector<std::string>> CaseTable(const std::vector<CaseRow>& rows);

// CaseTable as GitHub Markdown.
std::string CasesMarkdown(const std::vector<CaseRow>& rows);

}  // namespace graspdb::client
