#include "storage/uploads/upload_commit.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "google/protobuf/util/time_util.h"
#include "storage/records/record_kind.h"

namespace graspdb::storage {
namespace {

class Commit {
 public:
  Commit(const Database& database, bool skip_failed, const std::function<bool()>& is_cancelled,
         UploadRecord* upload, ChangeBatch& batch)
      : database_(database),
        skip_failed_(skip_failed),
        is_cancelled_(is_cancelled),
        upload_(*upload),
        batch_(batch) {}

  absl::Status Run() {
    const auto add = [&](const std::string& name,
                         StagedViewRecord& staged) -> absl::StatusOr<bool> {
      RETURN_IF_ERROR(CheckNotCancelled());
      RETURN_IF_ERROR(Add(name, staged));
      RETURN_IF_ERROR(
          database_.Delete(Family::kStagedViews, StagedKey(upload_, name), batch_.rocks()));
      return true;
    };
    RETURN_IF_ERROR(VisitStaged(database_, upload_, "", add));
    RETURN_IF_ERROR(CheckNotCancelled());  // for the last time
    upload_.set_commit_revision(batch_.meta().revision());
    *upload_.mutable_commit_time() = batch_.time();
    return database_.Put(Family::kUploads, upload_.name(), upload_.SerializeAsString(),
                         batch_.rocks());
  }

 private:
  absl::Status CheckNotCancelled() const {
    if (!is_cancelled_ || !is_cancelled_()) return absl::OkStatus();
    return absl::CancelledError(upload_.name() +
                                " was not committed, its views are safe; commit it again");
  }

  absl::Status Add(const std::string& name, StagedViewRecord& staged) {
    if (staged.has_error()) return Fail(name, staged.error().message());
    ViewRecord& view = *staged.mutable_view();
    ASSIGN_OR_RETURN(const auto parent, ParentOf(name));
    if (!parent) return Drop(name, "its stable pose does not exist any more");
    if (IsOfAnother(*parent, staged)) {
      return Drop(name,
                  "its stable pose was deleted and created again since the view was sent; delete "
                  "this upload, and send the views again");
    }
    const auto stored = ReadRecord<ViewRecord>(database_, name);
    if (!stored.ok() && !absl::IsNotFound(stored.status())) return stored.status();
    if (stored.ok() && stored->content_digest() == view.content_digest()) {
      upload_.set_existing_count(upload_.existing_count() + 1);
      return RemoveCloud(name);
    }
    if (stored.ok() && !upload_.replace()) {
      return Drop(name, "the catalogue has a view of that name with other content");
    }
    Publish(name, stored.ok() ? &*stored : nullptr, &view);
    return absl::OkStatus();
  }

  void Publish(const std::string& name, const ViewRecord* replaced, ViewRecord* view) {
    if (batch_.changes().empty()) batch_.Begin();
    *view->mutable_create_time() = batch_.time();
    view->set_cloud_key(StagedKey(upload_, name));
    if (replaced != nullptr) {
      batch_.NoteRemovedCloud(CloudKeyOf(*replaced));
      batch_.Replace(Family::kViews, name, replaced->SerializeAsString(),
                     view->SerializeAsString());
      upload_.set_replaced_count(upload_.replaced_count() + 1);
    } else {
      batch_.Insert(Family::kViews, name, view->SerializeAsString());
      upload_.set_created_count(upload_.created_count() + 1);
    }
    batch_.NoteStoredCloud(view->cloud_key());
  }

  // The create time of the stable pose; nothing without one.
  using Parent = std::optional<google::protobuf::Timestamp>;

  absl::StatusOr<Parent> ParentOf(const std::string& name) {
    ASSIGN_OR_RETURN(const auto parent, Kind<ViewRecord>::ParentOf(name));
    const auto [at, is_new] = parents_.try_emplace(parent.name);
    if (is_new) {
      const auto pose = ReadRecord<v1::StablePose>(database_, parent.name);
      if (!pose.ok() && !absl::IsNotFound(pose.status())) return pose.status();
      if (pose.ok()) at->second = pose->create_time();
    }
    return at->second;
  }

  // Views that an earlier version staged have no time.
  static bool IsOfAnother(const google::protobuf::Timestamp& parent,
                          const StagedViewRecord& staged) {
    return staged.has_stable_pose_create_time() && staged.stable_pose_create_time() != parent;
  }

  // Leaves out a view that is staged.
  absl::Status Drop(const std::string& name, const std::string& why) {
    RETURN_IF_ERROR(Fail(name, why));
    return RemoveCloud(name);
  }

  absl::Status Fail(const std::string& name, const std::string& why) {
    upload_.set_failed_count(upload_.failed_count() + 1);
    if (skip_failed_) return absl::OkStatus();
    return FailedView(upload_, name, why);
  }

  // Not in the change record: no reader ever got it.
  absl::Status RemoveCloud(const std::string& name) {
    return database_.Delete(Family::kClouds, StagedKey(upload_, name), batch_.rocks());
  }

  const Database& database_;
  const bool skip_failed_;
  const std::function<bool()>& is_cancelled_;
  UploadRecord& upload_;
  ChangeBatch& batch_;
  std::map<std::string, Parent> parents_;
};

}  // namespace

std::string StagedKey(const UploadRecord& upload, std::string_view view_name) {
  return upload.staging_prefix() + "/" + std::string(view_name);
}

absl::Status VisitStaged(const Database& database, const UploadRecord& upload,
                         std::string_view after_name, StagedVisitor visit) {
  const std::string prefix = StagedKey(upload, "");
  const std::string after = after_name.empty() ? "" : StagedKey(upload, after_name);
  return database.Scan(Family::kStagedViews, prefix, after,
                       [&](std::string_view key, std::string_view value) -> absl::StatusOr<bool> {
                         StagedViewRecord staged;
                         if (!staged.ParseFromArray(value.data(), static_cast<int>(value.size()))) {
                           return DamagedRecord(key);
                         }
                         return visit(std::string(key.substr(prefix.size())), staged);
                       });
}

absl::Status FailedView(const UploadRecord& upload, std::string_view view_name,
                        std::string_view why) {
  return absl::FailedPreconditionError(absl::StrCat(
      upload.name(), " cannot be committed as a whole: ", std::string(view_name), ": ",
      std::string(why), "; list its failed views, send them again or commit without them"));
}

absl::Status AddCommit(const Database& database, bool skip_failed,
                       const std::function<bool()>& is_cancelled, UploadRecord* upload,
                       ChangeBatch& batch) {
  return Commit(database, skip_failed, is_cancelled, upload, batch).Run();
}

}  // namespace graspdb::storage
