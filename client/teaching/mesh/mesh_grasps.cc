#include "client/teaching/mesh/mesh_grasps.h"

#include <google/protobuf/util/json_util.h>

#include <algorithm>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/teaching/mesh/top_grasps.h"
#include "files/capture_sets/capture_check.h"
#include "files/messages/pose_message.h"
#include "program/text/json_keys.h"
#include "program/text/read_file.h"

namespace graspdb::client {
namespace {

namespace fs = std::filesystem;

// The sine of one degree: the tolerance for level poses in files.
constexpr double kLevel = 0.0175;

absl::Status Bad(const fs::path& path, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat(path.string(), what));
}

}  // namespace

absl::StatusOr<std::vector<v1::Grasp>> LoadGrasps(const fs::path& path) {
  ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path, kMaxGraspsFileBytes));
  v1::CapturedStablePose read;
  const auto parsed = google::protobuf::util::JsonStringToMessage(text, &read);
  if (!parsed.ok()) {
    const std::string complaint(parsed.message());
    return Bad(path, absl::StrCat(
                         " is not {\"grasps\": [...]}: ", complaint.substr(0, complaint.find('\n')),
                         "; use the format of `graspdb teach --dry-run --json`"));
  }
  if (absl::Status keys = CheckJsonKeys(text); !keys.ok()) {
    return Bad(path, absl::StrCat(": ", keys.message()));
  }
  if (read.grasps().empty()) return Bad(path, " has no grasps; give {\"grasps\": [...]}");
  v1::CapturedStablePose grasps;
  *grasps.mutable_grasps() = read.grasps();
  absl::Status checked = files::CheckStablePose(grasps, "");
  for (int i = 0; checked.ok() && i < grasps.grasps_size(); ++i) {
    checked = files::CheckId(grasps.grasps(i).grasp_id(), absl::StrCat(".grasps[", i, "].graspId"));
  }
  if (!checked.ok()) return Bad(path, absl::StrCat(": ", checked.message().substr(1)));
  return std::vector<v1::Grasp>(read.grasps().begin(), read.grasps().end());
}

absl::Status CheckForMesh(const std::vector<v1::Grasp>& grasps) {
  const auto turning = std::ranges::find_if(grasps, &v1::Grasp::has_free_turn);
  if (turning == grasps.end()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("grasp ", turning->grasp_id(),
                   " has a freeTurn, which is about the z axis of a stable pose; leave it out or "
                   "import it with --frame object"));
}

v1::Grasp FromMesh(v1::Grasp grasp, const recognition::Pose& object_mesh) {
  *grasp.mutable_tcp_pose() = files::ToMessage(object_mesh * files::FromMessage(grasp.tcp_pose()));
  return grasp;
}

std::string WhyOutOfReach(const v1::Grasp& grasp) {
  const recognition::Pose tcp = files::FromMessage(grasp.tcp_pose());
  const double rise = tcp.linear()(2, 2);  // of the approach
  const double height = tcp.translation().z();
  if (rise > kLevel) return "comes from below";
  if (height < kOffTableM) {
    return absl::StrFormat("is at %.1f mm, less than %.0f mm above the table", height * 1000,
                           kOffTableM * 1000);
  }
  if (height - rise * grasp.approach_distance_m() < kOffTableM) {
    return "begins its approach below the table";
  }
  return "";
}

std::vector<v1::Grasp> Merged(std::vector<v1::Grasp> grasps, const std::vector<v1::Grasp>& added) {
  for (const v1::Grasp& grasp : added) {
    const auto known = std::ranges::find(grasps, grasp.grasp_id(), &v1::Grasp::grasp_id);
    if (known == grasps.end()) {
      grasps.push_back(grasp);
    } else {
      *known = grasp;
    }
  }
  return grasps;
}

}  // namespace graspdb::client
