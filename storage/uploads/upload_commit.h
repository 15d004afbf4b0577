// The change that publishes the views of an upload. Internal to storage/.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "storage/changes/change_batch.h"
#include "storage/database/database.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// Key of a view of `upload` in the families `staged_views` and `clouds`.
std::string StagedKey(const UploadRecord& upload, std::string_view view_name);

// Returns false for the last view.
using StagedVisitor =
    absl::FunctionRef<absl::StatusOr<bool>(const std::string& view_name, StagedViewRecord& staged)>;
// Visits the staged views of an upload whose names come after `after_name` (empty: all), in the
// order of their names. DATA_LOSS for one that is damaged; the errors of `visit`.
absl::Status VisitStaged(const Database& database, const UploadRecord& upload,
                         std::string_view after_name, StagedVisitor visit);

// FAILED_PRECONDITION: this view prevents the commit of the whole upload.
absl::Status FailedView(const UploadRecord& upload, std::string_view view_name,
                        std::string_view why);

// Adds the change to `batch`, as documented at Uploads::Commit(), and fills in the counts and the
// revision of `upload`.
absl::Status AddCommit(const Database& database, bool skip_failed,
                       const std::function<bool()>& is_cancelled, UploadRecord* upload,
                       ChangeBatch& batch);

}  // namespace graspdb::storage
