#include "server/recognition/catalogue_check.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "recognition/look_alikes.h"
#include "server/requests/convert.h"

namespace graspdb::server {
namespace {

void FillGap(const recognition::Gap& gap, v1::SurfaceGap* out) {
  out->set_mean_m(gap.mean_m);
  out->set_largest_m(gap.largest_m);
}

v1::FindLookAlikesResponse ToProto(const recognition::CatalogueSimilarity& found,
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
    *message->mutable_pose() = PoseToProto(pair.similarity.b_a);
    message->set_nearly(pair.nearly);
    FillGap(pair.similarity.gap, message->mutable_gap());
  }
  return out;
}

v1::ThresholdProposal ToProto(const recognition::ThresholdProposal& proposal) {
  v1::ThresholdProposal out;
  out.set_stable_pose(proposal.stable_pose);
  out.set_asked_view_count(proposal.query_views);
  out.set_right_view_count(proposal.right_views);
  if (proposal.right_score) out.set_right_score(*proposal.right_score);
  if (proposal.wrong_score) out.set_wrong_score(*proposal.wrong_score);
  out.set_wrong_view(proposal.wrong_view);
  if (proposal.min_score) out.set_min_score(*proposal.min_score);
  return out;
}

// `object` may be empty.
absl::Status HasStablePoses(const recognition::CatalogueSnapshot& snapshot,
                            const std::string& object) {
  const std::string prefix = absl::StrCat(object, "/");
  const auto is_its = [&](const auto& named) { return absl::StartsWith(named.first, prefix); };
  if (object.empty() || std::ranges::any_of(*snapshot.stable_poses, is_its)) {
    return absl::OkStatus();
  }
  return absl::NotFoundError(
      absl::StrCat(object, " does not exist or has no stable poses; list the objects"));
}

}  // namespace

absl::StatusOr<v1::FindLookAlikesResponse> CatalogueCheck::FindLookAlikes(
    const v1::FindLookAlikesRequest& request, const recognition::IsCancelled& is_cancelled) {
  using Response = absl::StatusOr<v1::FindLookAlikesResponse>;
  return live_.WithSnapshot([&](const recognition::CatalogueSnapshot& snapshot) -> Response {
    RETURN_IF_ERROR(HasStablePoses(snapshot, request.object()));
    ASSIGN_OR_RETURN(const auto found, recognition::FindLookAlikes(snapshot, clouds_,
                                                                   request.object(), is_cancelled));
    return ToProto(found, snapshot.revision);
  });
}

absl::StatusOr<v1::ProposeThresholdsResponse> CatalogueCheck::ProposeThresholds(
    const v1::ProposeThresholdsRequest& request, const recognition::IsCancelled& is_cancelled,
    const recognition::ThresholdProgress& progress) {
  // Not retried when the catalogue changes, unlike calls that take milliseconds.
  const std::shared_ptr<const recognition::CatalogueSnapshot> snapshot = live_.snapshot();
  RETURN_IF_ERROR(HasStablePoses(*snapshot, request.object()));
  v1::ProposeThresholdsResponse out;
  out.set_catalog_revision(snapshot->revision);
  const auto proposals =
      recognition::ProposeThresholds(*snapshot, clouds_, request.object(), parameters_,
                                     is_cancelled, [&](std::size_t done, std::size_t count) {
                                       out.set_view_count(static_cast<int>(count));
                                       return progress(done, count);
                                     });
  if (absl::IsNotFound(proposals.status())) {
    return absl::AbortedError("views were deleted meanwhile; retry");
  }
  if (!proposals.ok()) return proposals.status();
  out.set_done_view_count(out.view_count());
  for (const auto& proposal : *proposals) *out.add_proposals() = ToProto(proposal);
  return out;
}

}  // namespace graspdb::server
