// How the report looks.
#pragma once

#include <string>

namespace graspdb::client {

// CSS of the page and its plots, for light and dark.
std::string PageStyle();

// CSS of a plot in a file of its own, for light and dark. Without variables, which only browsers
// know.
std::string PlotFileStyle();

}  // namespace graspdb::client
