#include "client/teaching/turn_moving.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/files/cloud_message.h"
#include "client/teaching/view_upload.h"

namespace graspdb::client {
namespace {

// The cloud stays what it is, so that the axis makes the difference (in hundredths of millimetres).
std::string MovedId(const v1::View& view, const Eigen::Vector2d& axis) {
  return absl::StrFormat("%s_%.0f_%.0f", ContentId(view.cloud()), 1e5 * axis.x(), 1e5 * axis.y());
}

}  // namespace

absl::Status MoveTurn(Client& client, const std::string& stable_pose, const Eigen::Vector2d& axis,
                      const std::optional<v1::AxisAlignedBox>& region) {
  const auto before = client.ListViews(stable_pose);
  if (!before.ok()) return before.status();
  std::vector<std::string> replaced;
  const auto make = [&](std::size_t i, v1::UploadViewsRequest* request) {
    const absl::StatusOr<v1::View> view = client.GetView((*before)[i].name());
    if (!view.ok()) return view.status();
    request->set_parent(stable_pose);
    request->set_view_id(MovedId(*view, axis));
    if (region) *request->mutable_region_of_interest() = *region;
    v1::View* moved = request->mutable_view();
    *moved->mutable_cloud() = view->cloud();
    *moved->mutable_sensor_pose() = view->sensor_pose();
    *moved->mutable_object_pose() = view->object_pose();
    moved->mutable_object_pose()->mutable_position()->set_x(axis.x());
    moved->mutable_object_pose()->mutable_position()->set_y(axis.y());
    moved->set_segmented(true);
    if (view->name() != absl::StrCat(stable_pose, "/views/", request->view_id())) {
      replaced.push_back(view->name());
    }
    return absl::OkStatus();
  };
  const auto taught = TeachViews(client, {.count = before->size(), .make = make}, {});
  if (!taught.ok()) return taught.status();
  for (const std::string& view : replaced) {
    absl::Status gone = client.DeleteView(view);
    if (!gone.ok() && !absl::IsNotFound(gone)) return gone;
  }
  return absl::OkStatus();
}

}  // namespace graspdb::client
