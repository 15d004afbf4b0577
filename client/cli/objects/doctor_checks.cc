#include "client/cli/objects/doctor_checks.h"

#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/cli/base/cache_text.h"
#include "client/cli/base/counted.h"
#include "files/capture_sets/capture_check.h"
#include "files/messages/pose_message.h"

namespace graspdb::client {
namespace {

// Half the angle that a wide depth camera sees, rad (Azure Kinect, wide: 60 degrees). Smaller,
// regions at the edge of its image are taken for invisible.
constexpr double kMaxViewAngle = 1.05;
// Points of the region along each side.
constexpr int kPointsPerSide = 9;
// No score is higher.
constexpr double kHighestScore = 1;

bool IsInView(const Eigen::Vector3d& point) {  // in the sensor frame
  return point.z() > 0 && std::atan2(std::hypot(point.x(), point.y()), point.z()) <= kMaxViewAngle;
}

bool IsSeen(const v1::AxisAlignedBox& region, const recognition::Pose& sensor_world) {
  const auto at = [](double min, double max, int step) {
    return min + (max - min) * step / (kPointsPerSide - 1);
  };
  for (int i = 0; i < kPointsPerSide * kPointsPerSide * kPointsPerSide; ++i) {
    const Eigen::Vector3d point(
        at(region.min().x(), region.max().x(), i % kPointsPerSide),
        at(region.min().y(), region.max().y(), i / kPointsPerSide % kPointsPerSide),
        at(region.min().z(), region.max().z(), i / kPointsPerSide / kPointsPerSide));
    if (IsInView(sensor_world * point)) return true;
  }
  return false;
}

// Views all around a stable pose; with steps of 60 degrees some azimuths are 30 degrees from the
// nearest view, which the search still reaches.
constexpr std::size_t kEnoughViews = 6;
// An upload of this age is not in progress any more.
constexpr absl::Duration kForgotten = absl::Hours(24);
// A tabletop's region is smaller, m; a larger one is mostly a mistake of units.
constexpr double kMaxRegionM = 5;
// Cameras, robots and workspaces of a cell are nearer and smaller; larger numbers are mostly
// millimetres.
constexpr double kMaxCellM = 20;
// Grasps are nearer to their object.
constexpr double kDoubtfulGraspM = 2;
// Minimum scores are printed with two digits.
constexpr double kSameScore = 0.005;

// Those of an n-fold symmetric pose repeat n times around it; of any turn one shows all.
std::size_t EnoughViewsOf(const v1::StablePose& pose) {
  const int order = pose.has_symmetry_order() ? pose.symmetry_order() : 1;
  if (order <= 0) return 1;
  const auto fold = static_cast<std::size_t>(order);
  return (kEnoughViews + fold - 1) / fold;
}

double LongestSide(const v1::AxisAlignedBox& box) {
  return std::max({box.max().x() - box.min().x(), box.max().y() - box.min().y(),
                   box.max().z() - box.min().z()});
}

double DistanceOf(const v1::Pose& pose) {
  const v1::Vector3& p = pose.position();
  return std::hypot(p.x(), p.y(), p.z());
}

void CheckDistance(const v1::Cell& cell, const v1::Pose& pose, const std::string& what,
                   Findings* out) {
  if (DistanceOf(pose) <= kMaxCellM) return;
  AddError(out, cell.name(), "its ", what, " is ", DistanceOf(pose),
           " m away; positions are in metres, not millimetres");
}

void CheckPlaces(const v1::Cell& cell, Findings* out) {
  CheckDistance(cell, cell.sensor_pose(), "camera", out);
  CheckDistance(cell, cell.flange_sensor_pose(), "camera on the flange", out);
  CheckDistance(cell, cell.robot_base_pose(), "robot", out);
  if (cell.has_sensor_pose() && cell.sensor_pose().position().z() <= 0) {
    AddWarning(out, cell.name(),
               "its camera is not above the table; correct the sensor pose with: graspdb cells "
               "level");
  }
  if (LongestSide(cell.workspace()) > kMaxCellM) {
    AddError(out, cell.name(), "its workspace is ", LongestSide(cell.workspace()),
             " m long; workspaces are in metres, not millimetres");
  }
}

void CheckGraspSize(const v1::StablePose& pose, const v1::Grasp& grasp, Findings* out) {
  const double longest = files::LongestLengthOf(grasp);
  if (longest <= kDoubtfulGraspM) return;
  AddError(out, pose.name(), "its grasp ", grasp.grasp_id(), " has a length of ", longest,
           " m; lengths are in metres, not millimetres");
}

absl::Time CreateTimeOf(const v1::Upload& upload) {
  return absl::FromUnixNanos(
      google::protobuf::util::TimeUtil::TimestampToNanoseconds(upload.create_time()));
}

std::string ObjectOf(const v1::StablePose& pose) {
  return pose.name().substr(0, pose.name().find("/stablePoses/"));
}

bool Overlap(const v1::AxisAlignedBox& a, const v1::AxisAlignedBox& b) {
  const auto overlap = [](double a_min, double a_max, double b_min, double b_max) {
    return a_min <= b_max && b_min <= a_max;
  };
  return overlap(a.min().x(), a.max().x(), b.min().x(), b.max().x()) &&
         overlap(a.min().y(), a.max().y(), b.min().y(), b.max().y()) &&
         overlap(a.min().z(), a.max().z(), b.min().z(), b.max().z());
}

}  // namespace

void CheckServer(const v1::CatalogStatus& status, std::string_view client_version, Findings* out) {
  if (status.server_version() != client_version) {
    AddWarning(out, "server", "has version ", status.server_version(), ", this program ",
               std::string(client_version), "; install the same version on both");
  }
  if (status.left_out_record_count() > 0) {
    AddError(out, "server", Counted(status.left_out_record_count(), "record"),
             " cannot be used, named in its log (event=record_left_out): teach the views "
             "again or delete them");
  }
  if (status.memory().refused_request_count() > 0) {
    AddWarning(out, "server", "rejected ",
               Counted(status.memory().refused_request_count(), "request"),
               " for lack of memory since its start; raise --memory-mib, or send depth "
               "images in place of clouds");
  }
  const std::string advice = CacheAdvice(status.model_cache());
  if (!advice.empty()) AddAdvice(out, "server", advice);
  if (status.view_count() == 0) {
    AddWarning(out, "server", "the catalogue is empty; teach it with: graspdb import SET");
  }
}

void CheckObject(const v1::Object& object, const std::vector<v1::StablePose>& stable_poses,
                 Findings* out) {
  if (!stable_poses.empty()) return;
  AddWarning(out, object.name(),
             "has no stable pose, so it is never recognised; teach it or delete it");
}

void CheckStablePose(const v1::StablePose& stable_pose, std::size_t views,
                     const OpenUpload& open_upload, Findings* out) {
  if (views == 0 && open_upload.has_views) {
    AddAdvice(out, stable_pose.name(), "has no views yet: they are in ", open_upload.name,
              ", which is open; run its import again, or use what was sent: graspdb uploads "
              "commit ",
              open_upload.name);
  } else if (views == 0 && !open_upload.name.empty()) {
    AddAdvice(out, stable_pose.name(), "has no views yet, while ", open_upload.name,
              " is in progress; if they are not in it when it is complete, teach "
              "them");
  } else if (views == 0) {
    AddWarning(out, stable_pose.name(),
               "has no views, so it is never recognised; teach it or delete it");
  } else if (views < EnoughViewsOf(stable_pose)) {
    AddAdvice(out, stable_pose.name(), "has only ", Counted(views, "view"),
              "; teach it every 30 degrees, or from CAD");
  }
  if (stable_pose.grasps().empty()) {
    AddAdvice(out, stable_pose.name(),
              "has no grasps, so robots get its pose only; add some with: graspdb grasps");
  }
  for (const v1::Grasp& grasp : stable_pose.grasps()) {
    CheckGraspSize(stable_pose, grasp, out);
    if (grasp.gripper_opening_m() > 0) continue;
    AddAdvice(out, stable_pose.name(), "its grasp ", grasp.grasp_id(), " has no gripper opening");
  }
}

void CheckThreshold(const v1::StablePose& stable_pose, const std::vector<v1::View>& views,
                    Findings* out) {
  if (!stable_pose.has_min_score()) return;
  const auto newer = std::ranges::count_if(
      views, [&](const v1::View& view) { return view.create_time() > stable_pose.update_time(); });
  if (newer == 0) return;
  AddAdvice(out, stable_pose.name(), Counted(newer, "view"), newer == 1 ? " is" : " are",
            " newer than its minimum score; check it with: graspdb objects thresholds ",
            ObjectOf(stable_pose));
}

void CheckProposal(const v1::StablePose& stable_pose, const v1::ThresholdProposal& proposal,
                   Findings* out) {
  const bool is_set = stable_pose.has_min_score();
  if (!is_set && !proposal.has_min_score()) return;
  const std::string apply =
      absl::StrCat("; set it with: graspdb objects thresholds ", ObjectOf(stable_pose), " --apply");
  if (!proposal.has_min_score()) {
    AddAdvice(out, stable_pose.name(),
              absl::StrFormat("has a minimum score of %.2f, where its views call for the default%s",
                              stable_pose.min_score(), apply));
    return;
  }
  const double excess = stable_pose.min_score() - proposal.min_score();
  if (is_set && std::abs(excess) < kSameScore) return;
  // A lower one lets more wrong detections pass; a higher one loses correct ones.
  AddFinding(
      out, is_set && excess < 0 ? Severity::kAdvice : Severity::kWarning, stable_pose.name(),
      absl::StrFormat("has %s, where its views call for %.2f%s",
                      is_set ? absl::StrFormat("a minimum score of %.2f", stable_pose.min_score())
                             : "the default minimum score",
                      proposal.min_score(), apply));
}

void CheckCell(const v1::Cell& cell, Findings* out) {
  if (!cell.has_sensor_pose() && !cell.has_flange_sensor_pose()) {
    AddWarning(
        out, cell.name(),
        "has no calibration, so poses are relative to the table under the camera; run: graspdb "
        "cells level, or let the robot calibrate a camera on its flange");
  }
  CheckPlaces(cell, out);
  if (!cell.has_region_of_interest()) {
    AddWarning(out, cell.name(),
               "has no region of interest, so all that the camera sees is searched; set --region");
  } else if (LongestSide(cell.region_of_interest()) > kMaxRegionM) {
    AddError(out, cell.name(), "its region is ", LongestSide(cell.region_of_interest()),
             " m long; regions are in metres, not millimetres");
  }
  if (cell.has_workspace() && cell.has_region_of_interest() &&
      !Overlap(cell.workspace(), cell.region_of_interest())) {
    AddError(
        out, cell.name(),
        "its workspace and its region do not overlap, so no grasp is ever proposed; both are in "
        "the world frame");
  }
}

void CheckLabels(const v1::Cell& cell, const std::set<std::string>& labels, Findings* out) {
  const auto is_used = [&](const std::string& label) { return labels.contains(label); };
  if (cell.labels().empty() || std::ranges::any_of(cell.labels(), is_used)) return;
  AddError(out, cell.name(), "no object has one of its labels (",
           absl::StrJoin(cell.labels(), ", "),
           "), so nothing is recognised; label objects with: graspdb objects set ID "
           "--labels, or the cell with: graspdb cells set --no-labels");
}

bool IsInProgress(const v1::Upload& upload, absl::Time now) {
  return upload.state() == v1::UPLOAD_STATE_OPEN && now - CreateTimeOf(upload) < kForgotten &&
         upload.staged_view_count() + upload.failed_view_count() < upload.expected_view_count();
}

void CheckUpload(const v1::Upload& upload, absl::Time now, Findings* out) {
  if (upload.state() != v1::UPLOAD_STATE_OPEN) return;
  const absl::Time created = CreateTimeOf(upload);
  if (now - created < kForgotten) return;
  AddAdvice(out, upload.name(), "is open since ",
            absl::FormatTime("%Y-%m-%d %H:%M %Ez", created, absl::LocalTimeZone()),
            "; run its import again, or delete it with: graspdb uploads delete");
}

void CheckCameraView(const v1::Cell& cell, Findings* out) {
  if (!cell.has_sensor_pose() || !cell.has_region_of_interest()) return;
  const recognition::Pose world_sensor = files::FromMessage(cell.sensor_pose());
  if (IsSeen(cell.region_of_interest(), world_sensor.inverse())) return;
  AddError(out, cell.name(),
           "its camera does not see its region, so nothing is recognised; correct the region, or "
           "the sensor pose with: graspdb cells level");
}

void CheckMinScore(const v1::Cell& cell, Findings* out) {
  if (!cell.pipeline().has_min_score() || cell.pipeline().min_score() < kHighestScore) return;
  AddError(out, cell.name(),
           "its minimum score is 1, which no detection reaches, so nothing is recognised; lower "
           "it: graspdb cells set");
}

}  // namespace graspdb::client
