// Plots of the report as pictures of their own, for documents.
#pragma once

#include <string>
#include <vector>

namespace graspdb::client {

struct FigureFile {
  std::string name;  // e.g. "paper-mean-absolute-rotation-error-for-each-object.svg"
  std::string svg;   // with its style, for light and dark
};

// The plots in `markup`, a section of the page, in their order. Names are made from `section` and
// the plots' titles; those of one name are numbered.
std::vector<FigureFile> FigureFiles(const std::string& section, const std::string& markup);

}  // namespace graspdb::client
