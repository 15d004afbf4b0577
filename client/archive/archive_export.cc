#include "client/archive/archive_export.h"

#include <algorithm>
#include <deque>
#include <future>
#include <utility>

#include "absl/strings/str_cat.h"
#include "files/archive_writer.h"

namespace graspdb::client {
namespace {

// Views that are read at the same time, so that a distant server does not make each wait. Doubled,
// the export takes twice the memory.
constexpr std::size_t kViewsAtOnce = 4;

class ArchiveExport {
 public:
  ArchiveExport(Client& client, files::ArchiveWriter writer, const ExportWatch& watch)
      : client_(client), writer_(std::move(writer)), watch_(watch) {}

  absl::StatusOr<ExportResult> Run(const std::vector<std::string>& names) {
    if (absl::Status go = GoOn(); !go.ok()) return go;
    const auto before = client_.GetCatalogStatus();
    if (!before.ok()) return before.status();
    const auto objects = ObjectsOf(names);
    if (!objects.ok()) return objects.status();
    const auto total = names.empty() ? before->view_count() : CountViews(*objects);
    if (!total.ok()) return total.status();
    total_ = *total;
    v1::ArchiveRecord record;
    record.mutable_header()->set_catalog_revision(before->catalog_revision());
    result_.header = record.header();
    if (absl::Status added = writer_.Add(record); !added.ok()) return added;
    for (const v1::Object& object : *objects) {
      if (absl::Status added = AddObject(object); !added.ok()) return Explained(added);
    }
    const auto after = client_.GetCatalogStatus();
    if (!after.ok()) return after.status();
    result_.end.set_catalog_revision(after->catalog_revision());
    *record.mutable_end() = result_.end;
    if (absl::Status added = writer_.Add(record); !added.ok()) return added;
    if (absl::Status finished = writer_.Finish(); !finished.ok()) return finished;
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
      absl::StatusOr<v1::Object> object = client_.GetObject(name);
      if (!object.ok()) return object.status();
      out.push_back(*std::move(object));
    }
    return out;
  }

  absl::StatusOr<std::int64_t> CountViews(const std::vector<v1::Object>& objects) {
    std::int64_t out = 0;
    for (const v1::Object& object : objects) {
      const auto poses = client_.ListStablePoses(object.name());
      if (!poses.ok()) return poses.status();
      for (const v1::StablePose& pose : *poses) {
        if (absl::Status go = GoOn(); !go.ok()) return go;
        const auto views = client_.ListViews(pose.name());
        if (!views.ok()) return views.status();
        out += static_cast<std::int64_t>(views->size());
      }
    }
    return out;
  }

  absl::Status AddObject(const v1::Object& object) {
    if (absl::Status go = GoOn(); !go.ok()) return go;
    v1::ArchiveRecord record;
    *record.mutable_object() = object;
    record.mutable_object()->clear_etag();
    if (absl::Status added = writer_.Add(record); !added.ok()) return added;
    result_.end.set_object_count(result_.end.object_count() + 1);
    const auto poses = client_.ListStablePoses(object.name());
    if (!poses.ok()) return poses.status();
    for (const v1::StablePose& pose : *poses) {
      if (absl::Status added = AddStablePose(pose); !added.ok()) return added;
    }
    return absl::OkStatus();
  }

  absl::Status AddStablePose(const v1::StablePose& pose) {
    if (absl::Status go = GoOn(); !go.ok()) return go;
    v1::ArchiveRecord record;
    *record.mutable_stable_pose() = pose;
    record.mutable_stable_pose()->clear_etag();
    if (absl::Status added = writer_.Add(record); !added.ok()) return added;
    result_.end.set_stable_pose_count(result_.end.stable_pose_count() + 1);
    const auto views = client_.ListViews(pose.name());
    if (!views.ok()) return views.status();
    std::deque<std::future<absl::StatusOr<v1::View>>> pending;
    for (std::size_t next = 0; next < views->size() || !pending.empty();) {
      if (next < views->size() && pending.size() < kViewsAtOnce) {
        const std::string& name = (*views)[next++].name();
        pending.push_back(
            std::async(std::launch::async, [this, &name] { return client_.GetView(name); }));
        continue;
      }
      absl::Status added = AddView(pending.front().get());
      if (!added.ok()) return added;
      pending.pop_front();
    }
    return absl::OkStatus();
  }

  absl::Status AddView(absl::StatusOr<v1::View> view) {
    if (absl::Status go = GoOn(); !go.ok()) return go;
    if (!view.ok()) return view.status();
    v1::ArchiveRecord record;
    *record.mutable_view() = *std::move(view);
    if (absl::Status added = writer_.Add(record); !added.ok()) return added;
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
  absl::StatusOr<files::ArchiveWriter> writer = files::ArchiveWriter::Create(path);
  if (!writer.ok()) return writer.status();
  return ArchiveExport(client, *std::move(writer), watch).Run(objects);
}

}  // namespace graspdb::client
