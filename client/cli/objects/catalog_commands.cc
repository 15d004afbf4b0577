#include <cstdio>
#include <memory>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "base/status_macros.h"
#include "client/cli/base/cache_text.h"
#include "client/cli/base/counted.h"
#include "client/cli/base/progress_line.h"
#include "client/cli/objects/commands.h"
#include "client/teaching/turntable/look_alikes_text.h"
#include "files/base/json_object.h"
#include "program/text/printable_text.h"

namespace graspdb::client {
namespace {

struct ThresholdsOptions {
  std::string id;
  bool apply = false;
};

absl::StatusOr<v1::ProposeThresholdsResponse> Propose(Client& client, const std::string& object) {
  ProgressLine progress;
  return client.ProposeThresholds(object, [&](const v1::ProposeThresholdsResponse& response) {
    if (Interrupted()) return absl::CancelledError("stopped; nothing was changed");
    if (response.view_count() > 0)
      progress.Report(response.done_view_count(), response.view_count());
    return absl::OkStatus();
  });
}

absl::Status Apply(Client& client, const v1::ThresholdProposal& proposal) {
  v1::UpdateStablePoseRequest request;
  request.mutable_stable_pose()->set_name(proposal.stable_pose());
  if (proposal.has_min_score()) {
    request.mutable_stable_pose()->set_min_score(proposal.min_score());
  }
  request.mutable_update_mask()->add_paths("min_score");
  return client.UpdateStablePose(request).status();
}

absl::Status ProposeThresholds(const GlobalOptions& global, const ThresholdsOptions& options) {
  Client client = Connect(global);
  ASSIGN_OR_RETURN(const auto found,
                   Propose(client, options.id.empty() ? "" : ResourceName("objects", options.id)));
  for (const v1::ThresholdProposal& proposal : found.proposals()) {
    if (!global.json) std::printf("%s\n", ThresholdText(proposal).c_str());
    if (!options.apply) continue;
    absl::Status applied = Apply(client, proposal);
    if (!applied.ok()) {
      return WithMessage(applied,
                         absl::StrCat(proposal.stable_pose(), " and those after it keep their ",
                                      "thresholds: ", applied.message()));
    }
  }
  if (global.json) return PrintJson(found);
  if (found.proposals().empty()) {
    std::printf("there are no views to evaluate; teach some with: graspdb import SET\n");
  } else if (!options.apply) {
    std::printf("nothing was changed; --apply sets these thresholds\n");
  }
  return absl::OkStatus();
}

void PrintObject(const v1::Object& object) {
  std::string notes;
  if (!object.labels().empty()) {
    absl::StrAppend(&notes, " [", absl::StrJoin(object.labels(), ", "), "]");
  }
  if (object.release() == v1::RELEASE_STATE_DRAFT) absl::StrAppend(&notes, " (draft)");
  if (object.has_purge_time()) {
    absl::StrAppend(&notes, " deleted ", LocalTimeText(object.delete_time()),
                    ", can be brought back until ", LocalTimeText(object.purge_time()));
  }
  std::printf("%-40s %s%s\n", object.name().c_str(), PrintableText(object.display_name()).c_str(),
              notes.c_str());
}

absl::Status ListObjects(const GlobalOptions& global, bool deleted) {
  Client client = Connect(global);
  ASSIGN_OR_RETURN(std::vector<v1::Object> objects,
                   deleted ? client.ListDeletedObjects() : client.ListObjects());
  for (const v1::Object& object : objects) {
    if (global.json) {
      RETURN_IF_ERROR(PrintJson(object));
    } else {
      PrintObject(object);
    }
  }
  if (objects.empty() && !global.json && !deleted) {
    std::printf("the catalogue is empty; teach it with: graspdb import SET\n");
  }
  return absl::OkStatus();
}

void PrintStablePose(const v1::StablePose& pose, std::size_t views) {
  const int order = pose.has_symmetry_order() ? pose.symmetry_order() : 1;
  std::printf("  %s: %s, symmetry %s%s\n", pose.name().c_str(), Counted(views, "view").c_str(),
              order == 0 ? "any turn" : (std::to_string(order) + "-fold").c_str(),
              pose.release() == v1::RELEASE_STATE_DRAFT ? " (draft)" : "");
  if (pose.has_min_score()) std::printf("    minimum score %.2f\n", pose.min_score());
  if (pose.has_mesh_pose()) {
    const v1::Vector3& p = pose.mesh_pose().position();
    std::printf("    mesh frame: origin at %.3f %.3f %.3f m\n", p.x(), p.y(), p.z());
  }
  for (const v1::Grasp& grasp : pose.grasps()) {
    const v1::Vector3& p = grasp.tcp_pose().position();
    std::printf("    grasp %s: at %.3f %.3f %.3f m, approach %.3f m, opening %.3f m, priority %d\n",
                grasp.grasp_id().c_str(), p.x(), p.y(), p.z(), grasp.approach_distance_m(),
                grasp.gripper_opening_m(), grasp.priority());
  }
}

absl::Status PrintObjectJson(const v1::Object& object, const std::vector<v1::StablePose>& poses,
                             const std::vector<std::size_t>& view_counts) {
  std::vector<google::protobuf::Value> documents(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    ASSIGN_OR_RETURN(*documents[i].mutable_struct_value(), ToDocument(poses[i]));
    files::JsonObject(&documents[i]).Set(files::Json("viewCount", view_counts[i]));
  }
  ASSIGN_OR_RETURN(google::protobuf::Struct out, ToDocument(object));
  files::JsonObject(&out).Set(files::Json("stablePoses", documents));
  return PrintJson(out);
}

absl::Status ShowObject(const GlobalOptions& global, const std::string& id) {
  Client client = Connect(global);
  ASSIGN_OR_RETURN(v1::Object object, client.GetObject(ResourceName("objects", id)));
  ASSIGN_OR_RETURN(const std::vector<v1::StablePose> poses, client.ListStablePoses(object.name()));
  std::vector<std::size_t> view_counts;
  for (const v1::StablePose& pose : poses) {
    ASSIGN_OR_RETURN(const std::vector<v1::View> views, client.ListViews(pose.name()));
    view_counts.push_back(views.size());
  }
  if (global.json) return PrintObjectJson(object, poses, view_counts);
  PrintObject(object);
  for (std::size_t i = 0; i < poses.size(); ++i) PrintStablePose(poses[i], view_counts[i]);
  return absl::OkStatus();
}

absl::Status DeleteObject(const GlobalOptions& global, const std::string& id, bool force) {
  const std::string name = ResourceName("objects", id);
  Client client = Connect(global);
  absl::Status status = client.DeleteObject(name, force);
  if (!status.ok() || global.json) return status;
  std::printf("deleted %s\n", name.c_str());
  // Servers of before have no deleted objects.
  if (const auto deleted = client.GetDeletedObject(name); deleted.ok()) {
    std::printf("until %s it can be brought back: graspdb objects undelete %s\n",
                LocalTimeText(deleted->purge_time()).c_str(), id.c_str());
  }
  return absl::OkStatus();
}

struct ObjectChange {
  std::string id;
  bool has_display_name = false;
  std::string display_name;
  std::vector<std::string> labels;
  bool no_labels = false;
};

absl::Status SetObject(const GlobalOptions& global, const ObjectChange& change) {
  v1::UpdateObjectRequest request;
  request.mutable_object()->set_name(ResourceName("objects", change.id));
  google::protobuf::FieldMask* mask = request.mutable_update_mask();
  if (change.has_display_name) {
    request.mutable_object()->set_display_name(change.display_name);
    mask->add_paths("display_name");
  }
  for (const std::string& label : change.labels) request.mutable_object()->add_labels(label);
  if (change.no_labels || !change.labels.empty()) mask->add_paths("labels");
  if (mask->paths().empty()) {
    return WrongUsage(
        absl::InvalidArgumentError("nothing to set; give --display-name, --labels or --no-labels"));
  }
  ASSIGN_OR_RETURN(v1::Object object, Connect(global).UpdateObject(request));
  if (global.json) return PrintJson(object);
  PrintObject(object);
  return absl::OkStatus();
}

void AddSetCommand(CLI::App& objects, const GlobalOptions& global, Action* action) {
  auto change = std::make_shared<ObjectChange>();
  CLI::App* set = AddCommand(objects, "set", "Change the display name and labels of an object");
  set->add_option("OBJECT", change->id, "Id, e.g. mug")->required();
  const CLI::Option* name =
      set->add_option("--display-name", change->display_name, "Name for people; \"\" removes it");
  CLI::Option* labels =
      set->add_option("--labels", change->labels,
                      "Labels by which robot jobs and cells select it; replaces all labels")
          ->delimiter(',')
          ->type_name("LABEL,...");
  set->add_flag("--no-labels", change->no_labels, "Remove all labels")->excludes(labels);
  set->callback([=, &global] {
    change->has_display_name = name->count() > 0;
    *action = [=, &global] { return SetObject(global, *change); };
  });
}

absl::Status CheckObjects(const GlobalOptions& global, const std::string& id) {
  ASSIGN_OR_RETURN(const auto found,
                   Connect(global).FindLookAlikes(id.empty() ? "" : ResourceName("objects", id)));
  if (global.json) return PrintJson(found);
  const std::vector<std::string> notes = LookAlikesText(found, /*nearly_too=*/true);
  for (const std::string& note : notes) std::printf("%s\n", note.c_str());
  if (notes.empty()) std::printf("no look-alikes found\n");
  return absl::OkStatus();
}

std::string BackupsText(const v1::BackupStatus& status) {
  std::string text = "none";
  if (status.has_last_good_backup()) {
    text = absl::StrFormat("%d, the last good one %.1f h old, revision %d, %s",
                           status.backup_count(), status.last_good_age_s() / 3600,
                           status.last_good_backup().catalog_revision(),
                           BytesText(status.last_good_backup().byte_count()));
  }
  if (!status.last_error().empty())
    absl::StrAppend(&text, "; failed: ", PrintableText(status.last_error()));
  return text;
}

void PrintServerState(const v1::ServerState& state) {
  std::printf("disk        %s of %s free, database %s\n",
              BytesText(state.database_disk().available_byte_count()).c_str(),
              BytesText(state.database_disk().byte_count()).c_str(),
              BytesText(state.database_byte_count()).c_str());
  if (state.has_write_fault()) {
    std::printf("writes      fail since %s: %s\n",
                LocalTimeText(state.write_fault().time()).c_str(),
                PrintableText(state.write_fault().error()).c_str());
  }
  for (const v1::DamagedFile& file : state.damaged_files()) {
    std::printf("damaged     %s: %s\n", PrintableText(file.name()).c_str(),
                PrintableText(file.error()).c_str());
  }
  if (state.has_certificate_expire_time()) {
    std::printf("certificate until %s\n", LocalTimeText(state.certificate_expire_time()).c_str());
  }
  for (const v1::FileFault& fault : state.file_faults()) {
    std::printf("unusable    %s\n", fault.error().c_str());
  }
}

absl::Status ShowStatus(const GlobalOptions& global) {
  ASSIGN_OR_RETURN(v1::CatalogStatus status, Connect(global).GetCatalogStatus());
  if (global.json) return PrintJson(status);
  std::printf("server      %s, version %s, up %.0f s\n", global.server.c_str(),
              status.server_version().c_str(), status.uptime_s());
  std::printf("catalogue   %s, %s, %s\n", Counted(status.object_count(), "object").c_str(),
              Counted(status.stable_pose_count(), "stable pose").c_str(),
              Counted(status.view_count(), "view").c_str());
  std::printf("revision    %lld\n", static_cast<long long>(status.catalog_revision()));
  if (!status.catalog_id().empty()) {
    std::printf("catalog id  %s\n", status.catalog_id().c_str());
  }
  std::printf("picks       %lld picked, %lld missed, %lld slipped\n",
              static_cast<long long>(status.picked_count()),
              static_cast<long long>(status.missed_count()),
              static_cast<long long>(status.slipped_count()));
  std::printf("descriptor  %s\n", status.descriptor_name().c_str());
  std::printf("memory      %s\n", MemoryText(status.memory()).c_str());
  if (status.has_backup()) std::printf("backups     %s\n", BackupsText(status.backup()).c_str());
  if (status.has_server_state()) PrintServerState(status.server_state());
  std::printf("models      %s\n", CacheText(status.model_cache()).c_str());
  std::printf("clouds      %s\n", CacheText(status.cloud_cache()).c_str());
  const std::string advice = CacheAdvice(status.model_cache());
  if (!advice.empty()) std::printf("            %s\n", advice.c_str());
  return absl::OkStatus();
}

}  // namespace

void AddObjectsCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* objects =
      AddCommand(app, "objects", "List, show, set, release, check, delete and restore objects");
  objects->require_subcommand(1);
  auto deleted = std::make_shared<bool>(false);
  CLI::App* list = AddCommand(*objects, "list", "List all objects");
  list->add_flag("--deleted", *deleted, "The deleted objects that can be brought back");
  list->callback(
      [=, &global] { *action = [=, &global] { return ListObjects(global, *deleted); }; });
  auto id = std::make_shared<std::string>();
  CLI::App* show = AddCommand(*objects, "show",
                              "Print an object with its stable poses and grasps; with --json the "
                              "object alone, and `grasps list --json` the others");
  show->add_option("OBJECT", *id, "Id, e.g. mug")->required();
  show->callback([=, &global] { *action = [=, &global] { return ShowObject(global, *id); }; });
  CLI::App* check =
      AddCommand(*objects, "check",
                 "Find objects that may be confused: undeclared symmetries and look-alikes");
  check->add_option("OBJECT", *id, "Id, e.g. mug; default: all objects");
  check->callback([=, &global] { *action = [=, &global] { return CheckObjects(global, *id); }; });
  AddSetCommand(*objects, global, action);
  AddThresholdsCommand(*objects, global, action);
  AddHistoryCommands(*objects, global, action);
  auto force = std::make_shared<bool>(false);
  CLI::App* remove = AddCommand(*objects, "delete", "Delete an object");
  remove->add_option("OBJECT", *id, "Id, e.g. mug")->required();
  remove->add_flag("--force", *force, "Delete its stable poses and views as well");
  remove->callback(
      [=, &global] { *action = [=, &global] { return DeleteObject(global, *id, *force); }; });
}

void AddStatusCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  AddCommand(app, "status", "Print the state of the server and its catalogue")
      ->callback([=, &global] { *action = [&global] { return ShowStatus(global); }; });
}

std::string ThresholdText(const v1::ThresholdProposal& proposal) {
  std::string out = absl::StrFormat(
      "%s: %s; %d of %d views named", proposal.stable_pose(),
      proposal.has_min_score() ? absl::StrFormat("%.2f", proposal.min_score()) : "as all",
      proposal.right_view_count(), proposal.asked_view_count());
  if (proposal.has_right_score()) {
    absl::StrAppendFormat(&out, ", most with %.2f or more", proposal.right_score());
  }
  if (proposal.has_wrong_score()) {
    absl::StrAppendFormat(&out, "; %s taken for it with %.2f", proposal.wrong_view(),
                          proposal.wrong_score());
  }
  return out;
}

void AddThresholdsCommand(CLI::App& objects, const GlobalOptions& global, Action* action) {
  auto options = std::make_shared<ThresholdsOptions>();
  CLI::App* command = AddCommand(
      objects, "thresholds",
      "Propose minimum scores of stable poses: recognises up to eight views of each without "
      "itself, "
      "and without its object, and proposes a lower minimum score for stable poses whose correct "
      "detections score low. Run it again after teaching more.");
  command->add_option("OBJECT", options->id, "Id, e.g. mug; default: all objects");
  command->add_flag("--apply", options->apply,
                    "Set the proposed scores; stable poses without a proposal get the default");
  command->callback(
      [=, &global] { *action = [=, &global] { return ProposeThresholds(global, *options); }; });
}

}  // namespace graspdb::client
