// The views of a server.
#pragma once

#include <set>
#include <string>

namespace graspdb::end_to_end {

// Resource names of all views.
std::set<std::string> ViewNames(const std::string& address);

}  // namespace graspdb::end_to_end
