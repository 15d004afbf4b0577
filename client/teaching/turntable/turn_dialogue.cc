#include "client/teaching/turntable/turn_dialogue.h"

#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace graspdb::client {
namespace {

// A view with a smaller share of its neighbours' points is doubtful.
constexpr double kFewPoints = 0.4;
// Edges flicker, which is a third of the pixels of small objects; a turning object moves in most.
constexpr double kMoving = 0.5;
constexpr double kHoles = 0.8;
// The centroid of the visible points of an object on the axis is at most so far before the axis.
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
    const std::optional<std::string> answer = prompt_.Ask(
        absl::StrCat(kAskView, coverage_.AzimuthDeg(step),
                     " degrees and press Enter (r: repeat the last one, s: skip, q: stop) "));
    if (!answer) return false;
    const std::string word(absl::StripAsciiWhitespace(*answer));
    if (word == "q") return false;
    if (word == "s") {
      todo_.pop_front();
    } else if (word == "r" && last_ >= 0) {
      if (step != last_) todo_.push_front(last_);
    } else if (word == "r") {
      prompt_.Say("there is none to repeat yet");
    } else if (!word.empty()) {
      prompt_.Say(absl::StrCat("\"", word, "\" means nothing here; answer Enter, r, s or q"));
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
    prompt_.Say(absl::StrCat("not taught: ", std::string(taken.status().message())));
    return false;
  }
  if (!IsWanted(step, *taken)) {
    Remove(taken->view.name);
    return false;
  }
  // The one that is repeated goes once the new one is safe.
  if (const TurnView* before = coverage_.At(step); before != nullptr) Remove(before->name);
  coverage_.Set(step, taken->view);
  Tell(step, *taken);
  return true;
}

bool TurnDialogue::IsWanted(int step, const TakenView& taken) {
  if (taken.quality.moving_share > kMoving) {
    prompt_.Say("not taught: it moved while it was looked at; let it come to rest");
    return false;
  }
  const double usual = coverage_.NeighborPoints(step);
  if (taken.view.point_count >= kFewPoints * usual) return true;
  prompt_.Say(absl::StrFormat(
      "only %d points, where the views beside it have %.0f: is a hand or something else before it?",
      taken.view.point_count, usual));
  const std::optional<std::string> answer =
      prompt_.Ask("press Enter to take it again (k: keep it) ");
  return answer && absl::StripAsciiWhitespace(*answer) == "k";
}

void TurnDialogue::Tell(int step, const TakenView& taken) {
  prompt_.Say(
      absl::StrCat(coverage_.AzimuthDeg(step), " degrees: ", CaptureQualityText(taken.quality)));
  prompt_.Say(coverage_.Ring());
  if (taken.quality.measured_share < kHoles) {
    prompt_.Say(
        "  it has holes: a black, glossy or transparent surface, or too near to the camera; if "
        "other light or a matt spray mends that, repeat it with r");
  }
  const double off = (taken.center - turning_.origin).head<2>().norm();
  if (off > kFarFromAxisM && !told_of_axis_) {
    told_of_axis_ = true;
    prompt_.Say(absl::StrFormat(
        "  it stands %.0f mm beside the turntable's axis at %.3f,%.3f: check --axis, on which it "
        "depends whether the views fit together",
        1000 * off, turning_.origin.x(), turning_.origin.y()));
  }
}

void TurnDialogue::Remove(const std::string& view) {
  const absl::Status gone = client_.DeleteView(view);
  if (gone.ok() || absl::IsNotFound(gone)) return;
  prompt_.Say(absl::StrCat("cannot delete ", view, ": ", std::string(gone.message())));
}

}  // namespace graspdb::client
