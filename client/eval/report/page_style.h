// How the report looks.
#pragma once

#include <string>

namespace graspdb::client {

// CSS of the page and its plots, for light and dark.
std::string PageStyle();

}  // namespace graspdb::client
