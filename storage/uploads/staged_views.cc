// The views of uploads that are not committed: read, and described again.
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "storage/database/database.h"
#include "storage/records/record_kind.h"
#include "storage/uploads/open_upload.h"
#include "storage/uploads/upload_commit.h"
#include "storage/uploads/uploads.h"

namespace graspdb::storage {
namespace {

absl::Status NotStaged(std::string_view view_name) {
  return absl::NotFoundError(absl::StrCat(std::string(view_name), " is not staged"));
}

absl::StatusOr<StagedViewRecord> ReadStaged(const Database& database, const UploadRecord& upload,
                                            std::string_view view_name) {
  const std::string key = StagedKey(upload, view_name);
  const auto bytes = database.Get(Family::kStagedViews, key);
  if (absl::IsNotFound(bytes.status())) return NotStaged(view_name);
  if (!bytes.ok()) return bytes.status();
  StagedViewRecord staged;
  if (!staged.ParseFromString(*bytes)) return DamagedRecord(key);
  if (!staged.has_view()) return NotStaged(view_name);
  return staged;
}

}  // namespace

absl::StatusOr<std::string> Uploads::DigestOf(const UploadRecord& upload,
                                              std::string_view view_name) {
  ASSIGN_OR_RETURN(const auto open, OpenOf(upload));
  absl::MutexLock lock(&open->names);
  const Open::View* view = open->Find(view_name);
  if (view != nullptr && view->is_stored) return view->digest;
  return NotStaged(view_name);
}

absl::Status Uploads::ForEachView(
    const UploadRecord& upload, const std::function<absl::Status(const ViewRecord&)>& visit) const {
  return VisitStaged(
      database_, upload, "",
      [&](const std::string& /*name*/, const StagedViewRecord& staged) -> absl::StatusOr<bool> {
        RETURN_IF_ERROR(staged.has_view() ? visit(staged.view()) : absl::OkStatus());
        return true;
      });
}

absl::Status Uploads::CheckNoErrors(const UploadRecord& upload) {
  const auto counts = CountsOf(upload);
  if (!counts.ok() || counts->errors == 0) return counts.status();
  return VisitStaged(
      database_, upload, "",
      [&](const std::string& name, const StagedViewRecord& staged) -> absl::StatusOr<bool> {
        if (!staged.has_error()) return true;
        return FailedView(upload, name, staged.error().message());
      });
}

absl::StatusOr<NewView> Uploads::GetStaged(const UploadRecord& upload,
                                           std::string_view view_name) const {
  ASSIGN_OR_RETURN(auto staged, ReadStaged(database_, upload, view_name));
  const std::string key = StagedKey(upload, view_name);
  auto cloud = database_.Get(Family::kClouds, key);
  if (absl::IsNotFound(cloud.status())) {
    // Every staged view has a cloud, but the upload may have ended between the two reads.
    ASSIGN_OR_RETURN(const auto again, database_.Contains(Family::kStagedViews, key));
    return again ? DamagedRecord(key) : NotStaged(view_name);
  }
  if (!cloud.ok()) return cloud.status();
  return NewView{std::move(*staged.mutable_view()), *std::move(cloud)};
}

absl::Status Uploads::ReplaceDescriptors(const UploadRecord& upload,
                                         std::span<const DescriptorUpdate> updates) {
  if (updates.empty()) return absl::OkStatus();
  ASSIGN_OR_RETURN(const auto found, OpenOf(upload));
  Open& open = *found;
  // A view that is staged changes nowhere else, and nothing removes it meanwhile.
  absl::ReaderMutexLock use(&open.in_use);
  if (!open.end.ok()) return open.end;
  rocksdb::WriteBatch batch;
  for (const DescriptorUpdate& update : updates) {
    ASSIGN_OR_RETURN(auto staged, ReadStaged(database_, upload, update.view_name));
    staged.mutable_view()->mutable_descriptors()->Assign(update.descriptors.begin(),
                                                         update.descriptors.end());
    RETURN_IF_ERROR(database_.Put(Family::kStagedViews, StagedKey(upload, update.view_name),
                                  staged.SerializeAsString(), batch));
  }
  return database_.Write(batch);
}

}  // namespace graspdb::storage
