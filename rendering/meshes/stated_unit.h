// The unit of length that a mesh file states in a comment.
#pragma once

#include <optional>
#include <string_view>

namespace graspdb::rendering {

enum class UnitText { kComment, kName };

// The length of the unit after the word "unit" or "units" in `line`, in metres: of "# File units =
// millimeters", "UNITS=mm", or "1 unit = 1000.0 mm"; empty without one, and behind its first
// 200 characters. No format has a field for it. Names of parts
// may have the word "unit" too, as "power-unit-in-housing": there ":" or "=" must follow it.
std::optional<double> StatedUnit(std::string_view line, UnitText text);

}  // namespace graspdb::rendering
