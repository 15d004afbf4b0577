#include "files/depth/depth_unit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "recognition/base/units.h"

namespace graspdb::files {
namespace {

using recognition::kMmPerM;

constexpr double kDefaultUnitM = 0.001;
// Coarser counts are another unit: 65534 counts would reach 650 m.
constexpr double kCoarsestUnitM = 0.01;
// Relative difference of two keys that mean the same.
constexpr double kSame = 1e-3;
constexpr std::size_t kMaxInvalidCounts = 16;
constexpr char kAdvice[] = "; write the metres per count as depthUnitM instead";

// What the number of a key means.
enum class UnitKey { kNone, kMetres, kMillimetres, kMetresOrText, kByNumber, kOffset, kUnknown };

bool IsOneOf(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::ranges::find(names, name) != names.end();
}

bool HasPart(std::string_view name, std::string_view part) {
  return name.find(part) != std::string_view::npos;
}

bool HasPartOf(std::string_view name, std::initializer_list<std::string_view> parts) {
  return std::ranges::any_of(parts, [&](std::string_view part) { return HasPart(name, part); });
}

UnitKey UnitKeyOf(std::string_view name) {
  if (IsOneOf(name, {"depthunitm", "depthunitmetres", "depthunitmeters"})) return UnitKey::kMetres;
  if (IsOneOf(name, {"depthunitmm", "depthscalemm"})) return UnitKey::kMillimetres;
  if (IsOneOf(name, {"depthunit", "depthunits", "unit", "units"})) return UnitKey::kMetresOrText;
  const bool is_of_depth = HasPart(name, "depth");
  const bool is_scale = HasPartOf(name, {"scale", "factor"});
  if (is_of_depth && (is_scale || HasPartOf(name, {"shift", "divisor", "divider", "multiplier"}))) {
    return UnitKey::kByNumber;
  }
  if (HasPartOf(name, {"permet", "percount", "tomet"}) ||
      IsOneOf(name, {"scale", "factor", "scalefactor", "scalingfactor"})) {
    return UnitKey::kByNumber;
  }
  if (is_of_depth && HasPartOf(name, {"offset", "bias"})) return UnitKey::kOffset;
  return is_scale || HasPart(name, "unit") ? UnitKey::kUnknown : UnitKey::kNone;
}

std::optional<double> MetresOf(const std::string& unit) {
  const std::string name = absl::AsciiStrToLower(unit);
  if (IsOneOf(name, {"mm", "millimeter", "millimeters", "millimetre", "millimetres"})) return 1e-3;
  if (IsOneOf(name, {"um", "micrometer", "micrometers", "micrometre", "micrometres"})) return 1e-6;
  if (IsOneOf(name, {"cm", "centimeter", "centimeters", "centimetre", "centimetres"})) return 1e-2;
  return std::nullopt;
}

std::optional<double> MetresByNumber(double number) {
  if (number >= 1e-5 && number <= 0.002) return number;
  if (number >= 0.02 && number <= 2) return number / kMmPerM;
  if (number >= 100 && number <= 1e5) return 1 / number;
  return std::nullopt;
}

absl::Status BadUnit(const CameraEntry& entry, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("\"", entry.path, "\" ", what));
}

// INVALID_ARGUMENT unless a camera may have it.
absl::StatusOr<double> CheckedUnit(const CameraEntry& entry, double unit_m) {
  if (!(unit_m > 0)) return BadUnit(entry, "is not above 0");
  if (unit_m <= kCoarsestUnitM) return unit_m;
  return BadUnit(entry, absl::StrCat("is ", unit_m,
                                     " m per count, more than any depth camera has; "
                                     "if these are millimetres write ",
                                     unit_m / kMmPerM, ", if counts per metre ", 1 / unit_m));
}

absl::StatusOr<double> UnitFrom(const CameraEntry& entry, UnitKey key) {
  if (key == UnitKey::kUnknown) {
    return BadUnit(
        entry, absl::StrCat("may be a unit, but is not known", kAdvice, ", and remove the key"));
  }
  if (!entry.text.empty() && key != UnitKey::kMetres && key != UnitKey::kMillimetres) {
    const std::optional<double> unit_m = MetresOf(entry.text);
    if (unit_m) return *unit_m;
    return BadUnit(entry, absl::StrCat("is not \"mm\", \"um\" or \"cm\"", kAdvice));
  }
  if (entry.numbers.size() != 1 || !std::isfinite(entry.numbers[0])) {
    return BadUnit(entry, absl::StrCat("is not a number", kAdvice));
  }
  const double number = entry.numbers[0];
  if (key == UnitKey::kMetres) return CheckedUnit(entry, number);
  if (key == UnitKey::kMillimetres) return CheckedUnit(entry, number / kMmPerM);
  const std::optional<double> unit_m = MetresByNumber(number);
  if (unit_m && (key == UnitKey::kByNumber || number <= 0.002)) return *unit_m;
  return BadUnit(entry, absl::StrCat("is ", number,
                                     ", which may be metres or millimetres per "
                                     "count or counts per metre",
                                     kAdvice));
}

}  // namespace

absl::StatusOr<double> DepthUnitOf(const std::vector<CameraEntry>& entries) {
  const CameraEntry* from = nullptr;
  double unit_m = kDefaultUnitM;
  for (const CameraEntry& entry : entries) {
    const UnitKey key = UnitKeyOf(entry.name);
    if (key == UnitKey::kNone) continue;
    if (key == UnitKey::kOffset) {
      if (std::ranges::all_of(entry.numbers, [](double number) { return number == 0; })) continue;
      return BadUnit(entry, "is not 0; add it to the counts of the images, and remove the key");
    }
    ASSIGN_OR_RETURN(const double found, UnitFrom(entry, key));
    if (from != nullptr && std::abs(found - unit_m) > kSame * unit_m) {
      return BadUnit(entry, absl::StrCat("means ", found, " m per count and \"", from->path, "\" ",
                                         unit_m, "; keep the right one"));
    }
    from = &entry;
    unit_m = found;
  }
  return unit_m;
}

absl::StatusOr<std::vector<std::uint16_t>> InvalidCountsOf(
    const std::vector<CameraEntry>& entries) {
  constexpr double kMaxCount = std::numeric_limits<std::uint16_t>::max();
  std::vector<std::uint16_t> out;
  for (const CameraEntry& entry : entries) {
    if (!HasPart(entry.name, "invalid") && !HasPart(entry.name, "nodata")) continue;
    if (entry.numbers.empty() || entry.numbers.size() + out.size() > kMaxInvalidCounts) {
      return BadUnit(entry, absl::StrCat("is not one to ", kMaxInvalidCounts,
                                         " counts without measurement; write them as numbers"));
    }
    for (const double count : entry.numbers) {
      if (!(count >= 0 && count <= kMaxCount) || count != std::floor(count)) {
        return BadUnit(entry, "is no count of 16 bits; write 0 to 65535");
      }
      out.push_back(static_cast<std::uint16_t>(count));
    }
  }
  return out;
}

}  // namespace graspdb::files
