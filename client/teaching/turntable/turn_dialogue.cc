#include "client/teaching/turntable/turn_dialogue.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/teaching/upload/view_upload.h"
#include "files/messages/scan_message.h"

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

// A view with a smaller share of its neighbours' points needs confirmation.
constexpr double kFewPoints = 0.4;
// Edge pixels flicker, a third of the pixels of small objects; a turning object moves in most.
constexpr double kMoving = 0.5;
constexpr double kHoles = 0.8;
// Maximum distance of the visible points' centroid from the axis for an object on the axis.
constexpr double kFarFromAxisM = 0.1;

}  // namespace

TurnDialogue::TurnDialogue(ViewTaker& taker, Client& client, TeachingPrompt& prompt,
                           TurntableCoverage& coverage, Turning turning)
    : taker_(taker),
      client_(client),
      prompt_(prompt),
      coverage_(coverage),
      turning_(std::move(turning)) {
  for (const int step : coverage.Missing()) todo_.push_back(step);
}

bool TurnDialogue::Run() {
  while (!todo_.empty()) {
    const int step = todo_.front();
    const std::optional<std::string> answer = prompt_.ReadLine(
        absl::StrCat(kViewPrompt, coverage_.AzimuthDeg(step),
                     " degrees and press Enter (r: repeat the last one, s: skip, q: stop) "));
    if (!answer) return false;
    const std::string word(absl::StripAsciiWhitespace(*answer));
    if (word == "q") return false;
    if (word == "s") {
      todo_.pop_front();
    } else if (word == "r" && last_ >= 0) {
      if (step != last_) todo_.push_front(last_);
    } else if (word == "r") {
      prompt_.Print("there is no view to repeat yet");
    } else if (!word.empty()) {
      prompt_.Print(absl::StrCat("\"", word, "\" is not an answer; answer Enter, r, s or q"));
    } else if (Teach(step)) {
      todo_.pop_front();
      last_ = step;
      ++taught_;
    }
  }
  return true;
}

bool TurnDialogue::Teach(int step) {
  const double azimuth = (turning_.clockwise ? -1 : 1) * coverage_.AzimuthDeg(step);
  const absl::StatusOr<TakenView> taken = taker_.Take(
      turning_.stable_pose, OnTurntable(turning_.origin.head<2>(), turning_.origin.z(), azimuth));
  if (!taken.ok()) {
    prompt_.Print(absl::StrCat("not taught: ", std::string(taken.status().message())));
    return false;
  }
  if (!IsWanted(step, *taken)) {
    Remove(taken->view.name);
    return false;
  }
  // A repeated view is deleted after the new one is stored.
  if (const TurnView* before = coverage_.At(step); before != nullptr) Remove(before->name);
  coverage_.Set(step, taken->view);
  Report(step, *taken);
  return true;
}

bool TurnDialogue::IsWanted(int step, const TakenView& taken) {
  if (taken.quality.moving_share > kMoving) {
    prompt_.Print("not taught: the object moved during the capture; let it come to rest");
    return false;
  }
  const double usual = coverage_.NeighborPoints(step);
  if (taken.view.point_count >= kFewPoints * usual) return true;
  prompt_.Print(absl::StrFormat(
      "only %d points, where the views beside it have %.0f: is something in front of the object?",
      taken.view.point_count, usual));
  const std::optional<std::string> answer =
      prompt_.ReadLine("press Enter to take it again (k: keep it) ");
  return answer && absl::StripAsciiWhitespace(*answer) == "k";
}

void TurnDialogue::Report(int step, const TakenView& taken) {
  prompt_.Print(
      absl::StrCat(coverage_.AzimuthDeg(step), " degrees: ", CaptureQualityText(taken.quality)));
  prompt_.Print(coverage_.Ring());
  if (taken.quality.measured_share < kHoles) {
    prompt_.Print(
        "  it has holes: a black, glossy or transparent surface, or too near to the camera; if "
        "other light or a matt spray fixes that, repeat it with r");
  }
  const double off = (taken.center - turning_.origin).head<2>().norm();
  if (off > kFarFromAxisM && !reported_axis_) {
    reported_axis_ = true;
    prompt_.Print(absl::StrFormat(
        "  it stands %.0f mm beside the turntable's axis at %.3f,%.3f: check --axis; with a wrong "
        "axis the views do not fit together",
        1000 * off, turning_.origin.x(), turning_.origin.y()));
  }
}

void TurnDialogue::Remove(const std::string& view) {
  const absl::Status gone = client_.DeleteView(view);
  if (gone.ok() || absl::IsNotFound(gone)) return;
  prompt_.Print(absl::StrCat("cannot delete ", view, ": ", std::string(gone.message())));
}

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
