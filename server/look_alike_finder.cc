#include "server/look_alike_finder.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "recognition/look_alikes.h"
#include "server/convert.h"

namespace graspdb::server {
namespace {

void FillGap(const recognition::Gap& gap, v1::SurfaceGap* out) {
  out->set_mean_m(gap.mean_m);
  out->set_largest_m(gap.largest_m);
}

v1::FindLookAlikesResponse ToProto(const recognition::CatalogueLikeness& found,
                                   std::int64_t revision) {
  v1::FindLookAlikesResponse out;
  out.set_catalog_revision(revision);
  for (const recognition::StablePoseSymmetry& symmetry : found.symmetries) {
    v1::StablePoseSymmetry* message = out.add_symmetries();
    message->set_stable_pose(symmetry.stable_pose);
    message->set_declared_order(symmetry.declared_order);
    message->set_found_order(symmetry.found.order);
    message->set_nearly(symmetry.found.nearly);
    if (symmetry.found.order != 1) FillGap(symmetry.found.gap, message->mutable_gap());
  }
  for (const recognition::LookAlikes& pair : found.pairs) {
    v1::LookAlikePair* message = out.add_pairs();
    message->set_stable_pose(pair.stable_pose);
    message->set_other(pair.other);
    *message->mutable_pose() = PoseToProto(pair.likeness.b_a);
    message->set_nearly(pair.nearly);
    FillGap(pair.likeness.gap, message->mutable_gap());
  }
  return out;
}

}  // namespace

absl::StatusOr<v1::FindLookAlikesResponse> LookAlikeFinder::Answer(
    const v1::FindLookAlikesRequest& request, const recognition::IsCancelled& is_cancelled) {
  // A view may be deleted between the snapshot and the loading of its cloud; the
  // next snapshot does not have it any more.
  for (;;) {
    const std::shared_ptr<const recognition::CatalogueSnapshot> snapshot = live_.snapshot();
    const std::string prefix = absl::StrCat(request.object(), "/");
    if (!request.object().empty() &&
        std::ranges::none_of(*snapshot->stable_poses, [&](const auto& named) {
          return absl::StartsWith(named.first, prefix);
        })) {
      return absl::NotFoundError(
          absl::StrCat(request.object(), " is not there or has no stable poses; list the objects"));
    }
    const auto found =
        recognition::FindLookAlikes(*snapshot, clouds_, request.object(), is_cancelled);
    if (absl::IsNotFound(found.status()) && live_.snapshot() != snapshot) continue;
    if (!found.ok()) return found.status();
    return ToProto(*found, snapshot->revision);
  }
}

}  // namespace graspdb::server
