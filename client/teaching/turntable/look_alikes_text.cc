#include "client/teaching/turntable/look_alikes_text.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace graspdb::client {
namespace {

std::string TurnsText(int order) {
  if (order == 0) return "any turn";
  return order == 2 ? "half a turn" : absl::StrFormat("1/%d of a turn", order);
}

std::string Apart(const v1::SurfaceGap& gap) {
  return absl::StrFormat("%.1f mm apart on average", 1e3 * gap.mean_m());
}

std::string SymmetryText(const v1::StablePoseSymmetry& s) {
  if (s.found_order() == 1) {
    return absl::StrCat(s.stable_pose(), " is declared to look the same after ",
                        TurnsText(s.declared_order()),
                        ", but its views differ: correct symmetryOrder or the poses of the views");
  }
  const std::string what =
      absl::StrCat(s.stable_pose(), " looks ", s.nearly() ? "nearly " : "", "the same after ",
                   TurnsText(s.found_order()), ", ", Apart(s.gap()));
  if (s.nearly()) return absl::StrCat(what, ": detections may be AMBIGUOUS");
  return absl::StrCat(what, ": if these orientations are equivalent, declare symmetryOrder ",
                      s.found_order());
}

std::string PairText(const v1::LookAlikePair& pair) {
  return absl::StrCat(
      pair.stable_pose(), " and ", pair.other(), " look ",
      pair.nearly() ? "nearly alike, " : "alike, ", Apart(pair.gap()),
      pair.nearly() ? ": detections may be AMBIGUOUS" : ": detections will be AMBIGUOUS");
}

}  // namespace

std::vector<std::string> LookAlikesText(const v1::FindLookAlikesResponse& found, bool nearly_too) {
  std::vector<std::string> out;
  for (const v1::StablePoseSymmetry& symmetry : found.symmetries()) {
    if (symmetry.found_order() == symmetry.declared_order()) continue;
    if (nearly_too || !symmetry.nearly()) out.push_back(SymmetryText(symmetry));
  }
  for (const v1::LookAlikePair& pair : found.pairs()) {
    if (nearly_too || !pair.nearly()) out.push_back(PairText(pair));
  }
  return out;
}

}  // namespace graspdb::client
