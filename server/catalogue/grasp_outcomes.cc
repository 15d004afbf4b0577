#include "server/catalogue/grasp_outcomes.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "server/base/errors.h"
#include "server/requests/record_checks.h"

namespace graspdb::server {
namespace {

constexpr int kMaxAtOnce = 10'000;

absl::StatusOr<v1::GraspOutcomeCounts> CountsFromProto(
    const v1::ReportGraspOutcomeRequest& request) {
  const int count = request.has_count() ? request.count() : 1;
  if (count < 1 || count > kMaxAtOnce) {
    return InvalidField("count", absl::StrCat("must lie in 1 to ", kMaxAtOnce));
  }
  v1::GraspOutcomeCounts out;
  out.set_grasp_id(request.grasp_id());
  switch (request.outcome()) {
    case v1::GRASP_OUTCOME_PICKED:
      out.set_picked_count(count);
      return out;
    case v1::GRASP_OUTCOME_MISSED:
      out.set_missed_count(count);
      return out;
    case v1::GRASP_OUTCOME_SLIPPED:
      out.set_slipped_count(count);
      return out;
    default:
      return InvalidField("outcome", "must be PICKED, MISSED or SLIPPED");
  }
}

absl::StatusOr<storage::RequestKey> KeyFromProto(v1::ReportGraspOutcomeRequest request) {
  ASSIGN_OR_RETURN(std::string id, WriteIdFromProto(request.request_id()));
  if (id.empty()) return storage::RequestKey();
  request.clear_request_id();
  request.DiscardUnknownFields();
  return storage::RequestKey{std::move(id), Sha256(request.SerializeAsString())};
}

}  // namespace

absl::StatusOr<bool> ReportGraspOutcome(const v1::ReportGraspOutcomeRequest& request,
                                        storage::Catalogue& catalogue,
                                        v1::ReportGraspOutcomeResponse* response) {
  ASSIGN_OR_RETURN(const v1::GraspOutcomeCounts added, CountsFromProto(request));
  ASSIGN_OR_RETURN(const storage::RequestKey key, KeyFromProto(request));
  absl::StatusOr<storage::AddedOutcomes> counted =
      catalogue.AddGraspOutcomes(request.name(), added, key);
  if (absl::IsAlreadyExists(counted.status())) {
    return WithReason(counted.status(), "REQUEST_ID_REUSED");
  }
  if (!counted.ok()) return AtField("name", counted.status());
  *response->mutable_counts() = std::move(counted->counts);
  response->set_catalog_revision(counted->revision);
  return !counted->is_repeated;
}

absl::Status AddGraspOutcomes(const storage::Catalogue& catalogue, v1::StablePose* stable_pose) {
  absl::StatusOr<storage::GraspOutcomesRecord> record =
      catalogue.GetGraspOutcomes(stable_pose->name());
  // Deleted since it was read: treated as without outcomes.
  if (absl::IsNotFound(record.status())) return absl::OkStatus();
  if (!record.ok()) return record.status();
  *stable_pose->mutable_grasp_outcomes() = std::move(*record->mutable_counts());
  return absl::OkStatus();
}

absl::Status SumGraspOutcomes(const storage::Catalogue& catalogue, v1::CatalogStatus* status) {
  storage::RecordVisitor visitor;
  visitor.grasp_outcomes = [status](const storage::GraspOutcomesRecord& record) {
    for (const v1::GraspOutcomeCounts& counts : record.counts()) {
      status->set_picked_count(status->picked_count() + counts.picked_count());
      status->set_missed_count(status->missed_count() + counts.missed_count());
      status->set_slipped_count(status->slipped_count() + counts.slipped_count());
    }
    return absl::OkStatus();
  };
  return catalogue.ForEach(visitor).status();
}

}  // namespace graspdb::server
