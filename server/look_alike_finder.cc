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
  using Response = absl::StatusOr<v1::FindLookAlikesResponse>;
  const std::string prefix = absl::StrCat(request.object(), "/");
  return live_.WithSnapshot([&](const recognition::CatalogueSnapshot& snapshot) -> Response {
    const auto is_its = [&](const auto& named) { return absl::StartsWith(named.first, prefix); };
    if (!request.object().empty() && std::ranges::none_of(*snapshot.stable_poses, is_its)) {
      return absl::NotFoundError(
          absl::StrCat(request.object(), " is not there or has no stable poses; list the objects"));
    }
    const auto found =
        recognition::FindLookAlikes(snapshot, clouds_, request.object(), is_cancelled);
    if (!found.ok()) return found.status();
    return ToProto(*found, snapshot.revision);
  });
}

}  // namespace graspdb::server
