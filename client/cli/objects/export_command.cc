#include <cstdio>
#include <memory>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cli/base/counted.h"
#include "client/cli/base/progress_line.h"
#include "client/cli/objects/archive_commands.h"
#include "client/cli/objects/commands.h"
#include "files/capture_sets/capture_set.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "files/points/point_file.h"

namespace graspdb::client {
namespace {

struct ExportOptions {
  std::string folder;
  std::vector<std::string> objects;
};

// The id at the end of a resource name.
std::string IdOf(const std::string& name) { return name.substr(name.rfind('/') + 1); }

// A view to write.
struct Entry {
  std::string object_id;
  std::string stable_pose_id;
  std::string view;  // resource name
};

absl::Status ListObject(Client& client, const v1::Object& object, v1::CaptureSet* set,
                        std::vector<Entry>* entries) {
  v1::CapturedObject* captured = set->add_objects();
  captured->set_object_id(IdOf(object.name()));
  captured->set_display_name(object.display_name());
  ASSIGN_OR_RETURN(std::vector<v1::StablePose> poses, client.ListStablePoses(object.name()));
  for (const v1::StablePose& pose : poses) {
    v1::CapturedStablePose* captured_pose = captured->add_stable_poses();
    captured_pose->set_stable_pose_id(IdOf(pose.name()));
    if (pose.has_symmetry_order()) captured_pose->set_symmetry_order(pose.symmetry_order());
    if (pose.has_min_score()) captured_pose->set_min_score(pose.min_score());
    if (pose.has_mesh_pose()) *captured_pose->mutable_mesh_pose() = pose.mesh_pose();
    *captured_pose->mutable_grasps() = pose.grasps();
    ASSIGN_OR_RETURN(std::vector<v1::View> views, client.ListViews(pose.name()));
    for (const v1::View& view : views) {
      entries->push_back({IdOf(object.name()), IdOf(pose.name()), view.name()});
    }
  }
  return absl::OkStatus();
}

absl::Status WriteView(Client& client, const Entry& entry, files::CaptureSetWriter* writer,
                       v1::Capture* capture) {
  ASSIGN_OR_RETURN(v1::View view, client.GetView(entry.view));
  ASSIGN_OR_RETURN(recognition::Points points, files::PointsFromMessage(view.cloud()));
  files::PointFile file;
  file.points = std::move(points);
  file.width = static_cast<int>(file.points.size());
  file.height = 1;
  file.sensor_pose = files::FromMessage(view.sensor_pose());
  const std::string path = absl::StrCat("clouds/", entry.object_id, "/", entry.stable_pose_id, "_",
                                        IdOf(entry.view), ".pcd");
  capture->set_path(path);
  capture->set_split(v1::Capture::TEACH);
  capture->set_object_id(entry.object_id);
  capture->set_stable_pose_id(entry.stable_pose_id);
  *capture->mutable_object_pose() = view.object_pose();
  *capture->mutable_sensor_pose() = view.sensor_pose();
  capture->set_segmented(true);
  capture->set_view_id(IdOf(entry.view));
  return writer->AddCloud(path, file);
}

absl::Status RunExport(const GlobalOptions& global, const ExportOptions& options) {
  if (std::filesystem::exists(std::filesystem::path(options.folder) / files::kCaptureSetFile)) {
    return absl::AlreadyExistsError(
        absl::StrCat(options.folder, " already has a capture set; choose another folder"));
  }
  Client client = Connect(global);
  std::vector<v1::Object> objects;
  if (options.objects.empty()) {
    ASSIGN_OR_RETURN(objects, client.ListObjects());
  }
  for (const std::string& id : options.objects) {
    ASSIGN_OR_RETURN(v1::Object object, client.GetObject(ResourceName("objects", id)));
    objects.push_back(std::move(object));
  }
  v1::CaptureSet set;
  std::vector<Entry> entries;
  for (const v1::Object& object : objects) {
    RETURN_IF_ERROR(ListObject(client, object, &set, &entries));
  }
  files::CaptureSetWriter writer(options.folder);
  ProgressLine progress;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (Interrupted()) return absl::CancelledError("interrupted; captures.json was not written");
    RETURN_IF_ERROR(WriteView(client, entries[i], &writer, set.add_captures()));
    progress.Report(static_cast<int>(i + 1), static_cast<int>(entries.size()));
  }
  RETURN_IF_ERROR(writer.Finish(set));
  std::printf("wrote %s of %s to %s\n", Counted(entries.size(), "view").c_str(),
              Counted(objects.size(), "object").c_str(), options.folder.c_str());
  return absl::OkStatus();
}

}  // namespace

void AddExportCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* command = AddCommand(
      app, "export", "Write the catalogue, or some objects, as an archive or capture set");
  auto options = std::make_shared<ExportOptions>();
  command
      ->add_option("SET", options->folder,
                   "File to create, FILE.graspdb, or folder to create, of a capture set")
      ->required();
  command->add_option("--object", options->objects, "Only these objects");
  command->footer(
      "An archive (FILE.graspdb) is one file for another server, of any version and descriptor:\n"
      "objects with labels, stable poses with grasps, symmetry and counts of picks, views with\n"
      "poses and clouds. `graspdb import` compares and merges it. Its bytes are the same as long "
      "as\n"
      "the catalogue is.\n"
      "A capture set is a folder of point clouds for experiments and other programs, which "
      "`graspdb\n"
      "import` teaches. For a whole server, cells included, see `graspdb backup`.\n\n"
      "Examples: graspdb export plant-a.graspdb\n"
      "          graspdb export mug.graspdb --object mug\n"
      "          graspdb export captures/monday --object mug");
  command->callback([=, &global] {
    if (options->folder.empty()) throw CLI::ValidationError("SET", "give a file or a folder");
    *action = [=, &global] {
      return IsArchivePath(options->folder)
                 ? RunArchiveExport(global, options->folder, options->objects)
                 : RunExport(global, *options);
    };
  });
}

}  // namespace graspdb::client
