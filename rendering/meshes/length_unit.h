// Units of mesh files, which do not contain their own.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace graspdb::rendering {

struct LengthUnit {
  std::string_view name;
  double metres = 0;
};

inline constexpr std::array<LengthUnit, 4> kLengthUnits = {
    {{"mm", 0.001}, {"cm", 0.01}, {"m", 1}, {"inch", 0.0254}}};

// Their names, in that order.
inline std::vector<std::string> LengthUnitNames() {
  std::vector<std::string> names;
  names.reserve(kLengthUnits.size());
  for (const LengthUnit& unit : kLengthUnits) names.emplace_back(unit.name);
  return names;
}

// The length of the unit of that name in metres; empty for another name.
constexpr std::optional<double> MetresOf(std::string_view name) {
  for (const LengthUnit& unit : kLengthUnits) {
    if (unit.name == name) return unit.metres;
  }
  return std::nullopt;
}

}  // namespace graspdb::rendering
