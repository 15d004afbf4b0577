#include "client/archive/archive_export.h"

#include <algorithm>
#include <deque>
#include <future>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/archives/archive_file.h"

namespace graspdb::client {
namespace {

// Views that are read at the same time, so that a distant server does not make each wait.
constexpr std::size_t kViewsAtOnce = 4;

class ArchiveExport {
 public:
  ArchiveExport(Client& client, files::ArchiveWriter writer, const ExportWatch& watch)
      : client_(client), writer_(std::move(writer)), watch_(watch) {}

  absl::StatusOr<ExportResult> Run(const std::vector<std::string>& names) {
    RETURN_IF_ERROR(GoOn());
    ASSIGN_OR_RETURN(const auto before, client_.GetCatalogStatus());
    ASSIGN_OR_RETURN(const auto objects, ObjectsOf(names));
    ASSIGN_OR_RETURN(total_, names.empty() ? before.view_count() : CountViews(objects));
    v1::ArchiveRecord record;
    record.mutable_header()->set_catalog_revision(before.catalog_revision());
    result_.header = record.header();
    RETURN_IF_ERROR(writer_.Add(record));
    for (const v1::Object& object : objects) {
      if (absl::Status added = AddObject(object); !added.ok()) return Explained(added);
    }
    ASSIGN_OR_RETURN(const auto after, client_.GetCatalogStatus());
    result_.end.set_catalog_revision(after.catalog_revision());
    *record.mutable_end() = result_.end;
    RETURN_IF_ERROR(writer_.Add(record));
    RETURN_IF_ERROR(writer_.Finish());
    return result_;
  }

 private:
  absl::Status GoOn() const {
    if (!watch_.cancelled || !watch_.cancelled()) return absl::OkStatus();
    return absl::CancelledError("interrupted; no file was written");
  }

  absl::StatusOr<std::vector<v1::Object>> ObjectsOf(const std::vector<std::string>& names) {
    if (names.empty()) return client_.ListObjects();
    std::vector<v1::Object> out;
    out.reserve(names.size());
    for (const std::string& name : names) {
      ASSIGN_OR_RETURN(v1::Object object, client_.GetObject(name));
      out.push_back(std::move(object));
    }
    return out;
  }

  absl::StatusOr<std::int64_t> CountViews(const std::vector<v1::Object>& objects) {
    std::int64_t out = 0;
    for (const v1::Object& object : objects) {
      ASSIGN_OR_RETURN(const auto poses, client_.ListStablePoses(object.name()));
      for (const v1::StablePose& pose : poses) {
        RETURN_IF_ERROR(GoOn());
        ASSIGN_OR_RETURN(const auto views, client_.ListViews(pose.name()));
        out += static_cast<std::int64_t>(views.size());
      }
    }
    return out;
  }

  absl::Status AddObject(const v1::Object& object) {
    RETURN_IF_ERROR(GoOn());
    v1::ArchiveRecord record;
    *record.mutable_object() = object;
    record.mutable_object()->clear_etag();
    RETURN_IF_ERROR(writer_.Add(record));
    result_.end.set_object_count(result_.end.object_count() + 1);
    ASSIGN_OR_RETURN(const auto poses, client_.ListStablePoses(object.name()));
    for (const v1::StablePose& pose : poses) {
      RETURN_IF_ERROR(AddStablePose(pose));
    }
    return absl::OkStatus();
  }

  absl::Status AddStablePose(const v1::StablePose& pose) {
    RETURN_IF_ERROR(GoOn());
    v1::ArchiveRecord record;
    *record.mutable_stable_pose() = pose;
    record.mutable_stable_pose()->clear_etag();
    RETURN_IF_ERROR(writer_.Add(record));
    result_.end.set_stable_pose_count(result_.end.stable_pose_count() + 1);
    ASSIGN_OR_RETURN(const auto views, client_.ListViews(pose.name()));
    std::deque<std::future<absl::StatusOr<v1::View>>> pending;
    for (std::size_t next = 0; next < views.size() || !pending.empty();) {
      if (next < views.size() && pending.size() < kViewsAtOnce) {
        const std::string& name = views[next++].name();
        pending.push_back(
            std::async(std::launch::async, [this, &name] { return client_.GetView(name); }));
        continue;
      }
      RETURN_IF_ERROR(AddView(pending.front().get()));
      pending.pop_front();
    }
    return absl::OkStatus();
  }

  absl::Status AddView(absl::StatusOr<v1::View> view) {
    RETURN_IF_ERROR(GoOn());
    if (!view.ok()) return view.status();
    v1::ArchiveRecord record;
    *record.mutable_view() = *std::move(view);
    RETURN_IF_ERROR(writer_.Add(record));
    result_.end.set_view_count(result_.end.view_count() + 1);
    if (watch_.report) {
      watch_.report(result_.end.view_count(), std::max(total_, result_.end.view_count()));
    }
    return absl::OkStatus();
  }

  // What was listed and is gone.
  static absl::Status Explained(const absl::Status& status) {
    if (!absl::IsNotFound(status)) return status;
    return absl::AbortedError(
        absl::StrCat("the catalogue changed meanwhile; run the command again (",
                     std::string(status.message()), ")"));
  }

  Client& client_;
  files::ArchiveWriter writer_;
  const ExportWatch& watch_;
  std::int64_t total_ = 0;
  ExportResult result_;
};

}  // namespace

absl::StatusOr<ExportResult> ExportArchive(Client& client, std::vector<std::string> objects,
                                           const std::filesystem::path& path,
                                           const ExportWatch& watch) {
  std::ranges::sort(objects);
  objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
  ASSIGN_OR_RETURN(files::ArchiveWriter writer, files::ArchiveWriter::Create(path));
  return ArchiveExport(client, std::move(writer), watch).Run(objects);
}

}  // namespace graspdb::client
