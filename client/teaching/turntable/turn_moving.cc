#include "client/teaching/turntable/turn_moving.h"

#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/teaching/turntable/turntable_coverage.h"
#include "client/teaching/upload/view_upload.h"
#include "files/messages/cloud_message.h"

namespace graspdb::client {
namespace {

// The cloud is unchanged, so the id includes the axis (in hundredths of millimetres).
std::string MovedId(const v1::View& view, const Eigen::Vector2d& axis) {
  return absl::StrFormat("%s_%.0f_%.0f", files::ContentId(view), 1e5 * axis.x(), 1e5 * axis.y());
}

absl::Status Delete(Client& client, const std::vector<std::string>& views) {
  for (const std::string& view : views) {
    absl::Status gone = client.DeleteView(view);
    if (!gone.ok() && !absl::IsNotFound(gone)) return gone;
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status MoveTurn(Client& client, const std::string& stable_pose, const Eigen::Vector2d& axis,
                      const std::optional<v1::AxisAlignedBox>& region) {
  ASSIGN_OR_RETURN(const auto before, client.ListViews(stable_pose));
  std::vector<std::string> replaced;
  const auto make = [&](std::size_t i, v1::UploadViewsRequest* request) {
    ASSIGN_OR_RETURN(const v1::View view, client.GetView(before[i].name()));
    request->set_parent(stable_pose);
    request->set_view_id(MovedId(view, axis));
    if (region) *request->mutable_region_of_interest() = *region;
    v1::View* moved = request->mutable_view();
    *moved->mutable_cloud() = view.cloud();
    *moved->mutable_sensor_pose() = view.sensor_pose();
    *moved->mutable_object_pose() = view.object_pose();
    moved->mutable_object_pose()->mutable_position()->set_x(axis.x());
    moved->mutable_object_pose()->mutable_position()->set_y(axis.y());
    moved->set_segmented(true);
    if (view.name() != absl::StrCat(stable_pose, "/views/", request->view_id())) {
      replaced.push_back(view.name());
    }
    return absl::OkStatus();
  };
  RETURN_IF_ERROR(TeachViews(client, {.count = before.size(), .make = make}, {}).status());
  return Delete(client, replaced);
}

absl::StatusOr<std::vector<v1::View>> LeftByMove(Client& client, const std::string& stable_pose,
                                                 const Eigen::Vector3d& origin) {
  ASSIGN_OR_RETURN(auto views, client.ListViews(stable_pose));
  const std::size_t all = views.size();
  std::erase_if(views, [&](const v1::View& view) { return IsOfTurn(view, origin); });
  if (views.size() == all) views.clear();
  return views;
}

absl::Status OfferToEndMove(Client& client, TeachingPrompt& prompt, const std::string& stable_pose,
                            const Eigen::Vector3d& origin) {
  ASSIGN_OR_RETURN(const auto left, LeftByMove(client, stable_pose, origin));
  if (left.empty()) return absl::OkStatus();
  const v1::Vector3& at = left.front().object_pose().position();
  prompt.Print(
      absl::StrFormat("%d of the views are about another axis, %.4f,%.4f, as after an "
                      "interrupted move",
                      left.size(), at.x(), at.y()));
  const std::optional<std::string> answer =
      prompt.ReadLine("delete these views and continue with the others? (y: yes, Enter: no) ");
  if (!answer || absl::StripAsciiWhitespace(*answer) != "y") return absl::OkStatus();
  std::vector<std::string> names;
  names.reserve(left.size());
  for (const v1::View& view : left) names.push_back(view.name());
  return Delete(client, names);
}

}  // namespace graspdb::client
