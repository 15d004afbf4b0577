#include "client/cli/import_command.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <set>

#include "absl/strings/str_cat.h"
#include "client/cli/look_alikes_text.h"
#include "client/cli/splits.h"
#include "client/files/capture_set.h"
#include "client/files/cloud_message.h"
#include "client/files/pose_message.h"
#include "client/simulation/progress_line.h"

namespace graspdb::client {
namespace {

// Views in one upload call: after each call the server has said that they are safe.
constexpr int kViewsPerCall = 8;

// So many stable poses are compared with each other after an import without being asked to.
constexpr int kCheckedStablePoses = 100;
constexpr std::size_t kShownNotes = 5;

struct Options {
  std::string folder;
  std::string split = "TEACH";
  bool replace = false;
};

std::string StablePoseName(const v1::Capture& capture) {
  return absl::StrCat("objects/", capture.object_id(), "/stablePoses/", capture.stable_pose_id());
}

absl::Status IgnoreExisting(const absl::Status& status) {
  return absl::IsAlreadyExists(status) ? absl::OkStatus() : status;
}

// Makes the objects and stable poses of the set that are not there; the others
// keep what they have.
absl::Status CreateParents(Client& client, const v1::CaptureSet& set) {
  for (const v1::CapturedObject& object : set.objects()) {
    v1::CreateObjectRequest request;
    request.set_object_id(object.object_id());
    request.mutable_object()->set_display_name(object.display_name());
    absl::Status status = IgnoreExisting(client.CreateObject(request).status());
    if (!status.ok()) return status;
    for (const v1::CapturedStablePose& pose : object.stable_poses()) {
      v1::CreateStablePoseRequest pose_request;
      pose_request.set_parent("objects/" + object.object_id());
      pose_request.set_stable_pose_id(pose.stable_pose_id());
      v1::StablePose* message = pose_request.mutable_stable_pose();
      if (pose.has_symmetry_order()) message->set_symmetry_order(pose.symmetry_order());
      if (pose.has_min_score()) message->set_min_score(pose.min_score());
      *message->mutable_grasps() = pose.grasps();
      status = IgnoreExisting(client.CreateStablePose(pose_request).status());
      if (!status.ok()) return status;
    }
  }
  return absl::OkStatus();
}

// One import: what is left to send and what came of it.
class Import {
 public:
  Import(Client& client, const Options& options, const v1::CaptureSet& set)
      : client_(client),
        options_(options),
        set_(set),
        captures_(TeachableCaptures(set, options.split)) {}

  absl::Status Run() {
    if (captures_.empty()) {
      return absl::FailedPreconditionError(
          absl::StrCat(options_.folder, " has no captures to teach in split ", options_.split,
                       "; choose another --split or check captures.json"));
    }
    if (absl::Status status = CreateParents(client_, set_); !status.ok()) return status;
    progress_.emplace();
    while (next_ < captures_.size()) {
      if (Interrupted()) {
        return absl::CancelledError(
            absl::StrCat("interrupted after ", next_, " of ", captures_.size(),
                         " views, which are safe; run the same import again to go on"));
      }
      if (absl::Status status = SendSome(); !status.ok()) return status;
      progress_->Report(static_cast<int>(next_), static_cast<int>(captures_.size()));
    }
    return absl::OkStatus();
  }

  std::size_t total() const { return captures_.size(); }
  int created() const { return created_; }
  int existing() const { return existing_; }

 private:
  absl::Status SendSome() {
    int sent = 0;
    absl::StatusOr<v1::UploadViewsResponse> response =
        client_.UploadViews([&](v1::UploadViewsRequest* request) -> absl::StatusOr<bool> {
          while (next_ < captures_.size() && sent < kViewsPerCall) {
            absl::StatusOr<bool> wanted = Prepare(*captures_[next_++], request);
            if (!wanted.ok()) return wanted.status();
            if (!*wanted) continue;
            ++sent;
            return true;
          }
          return false;
        });
    if (!response.ok()) return response.status();
    created_ += response->created_count();
    existing_ += response->existing_count();
    return absl::OkStatus();
  }

  // Fills the request; false when the server has the view already.
  absl::StatusOr<bool> Prepare(const v1::Capture& capture, v1::UploadViewsRequest* request) {
    const std::filesystem::path path = std::filesystem::path(options_.folder) / capture.path();
    absl::StatusOr<PointFile> file = ReadPointFile(path);
    if (!file.ok()) return file.status();
    request->Clear();
    request->set_parent(StablePoseName(capture));
    v1::View* view = request->mutable_view();
    *view->mutable_cloud() = CloudMessage(file->points, file->width);
    request->set_view_id(capture.view_id().empty() ? ContentId(view->cloud()) : capture.view_id());
    absl::StatusOr<bool> known = IsKnown(request->parent(), request->view_id());
    if (!known.ok()) return known.status();
    if (*known && options_.replace) {
      absl::Status status =
          client_.DeleteView(absl::StrCat(request->parent(), "/views/", request->view_id()));
      if (!status.ok()) return status;
    } else if (*known) {
      ++existing_;
      return false;
    }
    view->set_segmented(capture.segmented());
    if (capture.has_object_pose()) *view->mutable_object_pose() = capture.object_pose();
    if (capture.has_sensor_pose()) {
      *view->mutable_sensor_pose() = capture.sensor_pose();
    } else if (file->sensor_pose) {
      *view->mutable_sensor_pose() = ToMessage(*file->sensor_pose);
    }
    if (set_.has_region_of_interest()) {
      *request->mutable_region_of_interest() = set_.region_of_interest();
    }
    return true;
  }

  absl::StatusOr<bool> IsKnown(const std::string& stable_pose, const std::string& view_id) {
    auto found = known_.find(stable_pose);
    if (found == known_.end()) {
      absl::StatusOr<std::vector<v1::View>> views = client_.ListViews(stable_pose);
      if (!views.ok()) return views.status();
      std::set<std::string> names;
      for (const v1::View& view : *views) names.insert(view.name());
      found = known_.emplace(stable_pose, std::move(names)).first;
    }
    return found->second.contains(absl::StrCat(stable_pose, "/views/", view_id));
  }

  Client& client_;
  const Options& options_;
  const v1::CaptureSet& set_;
  std::vector<const v1::Capture*> captures_;
  std::map<std::string, std::set<std::string>> known_;
  std::optional<ProgressLine> progress_;
  std::size_t next_ = 0;
  int created_ = 0;
  int existing_ = 0;
};

// Tells the teacher what may be confused.
absl::Status NoteLookAlikes(Client& client, const v1::CatalogStatus& status) {
  if (status.stable_pose_count() > kCheckedStablePoses) {
    std::fprintf(stderr, "note: see what may be confused with: graspdb objects check\n");
    return absl::OkStatus();
  }
  const auto found = client.FindLookAlikes("");
  if (!found.ok()) return found.status();
  const std::vector<std::string> notes = LookAlikesText(*found, /*nearly_too=*/false);
  for (std::size_t i = 0; i < std::min(notes.size(), kShownNotes); ++i) {
    std::fprintf(stderr, "note: %s\n", notes[i].c_str());
  }
  if (notes.size() > kShownNotes) {
    std::fprintf(stderr, "note: %zu more; see all with: graspdb objects check\n",
                 notes.size() - kShownNotes);
  }
  return absl::OkStatus();
}

absl::Status RunImport(const GlobalOptions& global, const Options& options) {
  absl::StatusOr<v1::CaptureSet> set = LoadCaptureSet(options.folder);
  if (!set.ok()) return set.status();
  Client client = Connect(global);
  Import import(client, options, *set);
  if (absl::Status status = import.Run(); !status.ok()) return status;
  absl::StatusOr<v1::CatalogStatus> status = client.GetCatalogStatus();
  if (!status.ok()) return status.status();
  if (global.json) {
    v1::UploadViewsResponse summary;
    summary.set_created_count(import.created());
    summary.set_existing_count(import.existing());
    summary.set_catalog_revision(status->catalog_revision());
    return PrintJson(summary);
  }
  std::printf(
      "taught %d views, %d were there already; the catalogue has %lld views of %lld objects\n",
      import.created(), import.existing(), static_cast<long long>(status->view_count()),
      static_cast<long long>(status->object_count()));
  if (import.created() > 0) return NoteLookAlikes(client, *status);
  return absl::OkStatus();
}

}  // namespace

void AddImportCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* command = AddCommand(app, "import", "Teach the captures of a set");
  auto options = std::make_shared<Options>();
  command->add_option("SET", options->folder, "Folder with captures.json")->required();
  AddSplitFlag(*command, &options->split);
  command->add_flag(
      "--replace", options->replace,
      "Teach captures again that are in the catalogue, e.g. after poses were corrected");
  command->footer(
      "Objects and stable poses are made as needed; those that exist keep their grasps.\n"
      "An import that was interrupted is run again: what is there is not taught twice.\n\n"
      "Example: graspdb import captures/monday");
  command->callback(
      [=, &global] { *action = [=, &global] { return RunImport(global, *options); }; });
}

}  // namespace graspdb::client
