#include "client/teaching/turntable/guided_teaching.h"

#include <algorithm>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/teaching/turntable/look_alikes_text.h"
#include "client/teaching/turntable/turntable_axis.h"
#include "client/teaching/upload/view_upload.h"

namespace graspdb::client {
namespace {

// Catalogues of up to this many stable poses are compared after teaching.
constexpr int kComparedStablePoses = 100;
// A larger error of the axis is visible in the models.
constexpr double kAxisOffM = 0.002;
// The matched share of the views is this much larger for the other turning direction.
constexpr double kTurnedTheOtherWay = 0.15;
constexpr int kHighestOrder = 360;
// The region ends this far below the plate, which excludes the table.
constexpr double kBelowPlateM = 0.01;

// The cell's region in the world of the plate, cut off below it.
std::optional<v1::AxisAlignedBox> RegionOf(const GuidedOptions& options) {
  if (!options.cell.has_region_of_interest()) return std::nullopt;
  v1::AxisAlignedBox region = options.cell.region_of_interest();
  if (options.plate_height_m == 0) return region;
  region.mutable_max()->set_z(region.max().z() - options.plate_height_m);
  region.mutable_min()->set_z(std::max(region.min().z() - options.plate_height_m, -kBelowPlateM));
  return region;
}

absl::StatusOr<Eigen::Vector2d> AxisOf(const GuidedOptions& options) {
  if (options.axis) return *options.axis;
  if (!options.cell.has_region_of_interest()) {
    return absl::FailedPreconditionError(absl::StrCat(
        "the turntable's axis is unknown; give --axis X,Y, or a region around the turntable "
        "with `graspdb cells set ",
        options.cell.name().substr(options.cell.name().find('/') + 1), " --region`"));
  }
  const v1::AxisAlignedBox& region = options.cell.region_of_interest();
  return Eigen::Vector2d((region.min().x() + region.max().x()) / 2,
                         (region.min().y() + region.max().y()) / 2);
}

// -1 if invalid.
int SymmetryOrder(const std::string& answer) {
  if (answer.empty()) return 1;
  if (answer == "any") return 0;
  int order = -1;
  if (!absl::SimpleAtoi(answer, &order)) return -1;
  return order >= 0 && order <= kHighestOrder ? order : -1;
}

}  // namespace

GuidedTeaching::GuidedTeaching(DepthSensor& sensor, Client& client, TeachingPrompt& prompt,
                               GuidedOptions options)
    : client_(client),
      prompt_(prompt),
      options_(std::move(options)),
      taker_(sensor, client,
             {.cell = options_.cell,
              .region = RegionOf(options_),
              .plate_height_m = options_.plate_height_m,
              .frames = options_.frames,
              .frame_timeout = options_.frame_timeout}) {}

absl::StatusOr<GuidedCounts> GuidedTeaching::Run() {
  RETURN_IF_ERROR(Begin());
  while (!counts_.stopped) {
    ASSIGN_OR_RETURN(const std::string id, PromptForStablePose());
    if (id.empty()) break;
    const absl::StatusOr<bool> made = MakeStablePose(id);
    if (absl::IsInvalidArgument(made.status())) {
      prompt_.Print(std::string(made.status().message()));
      continue;
    }
    if (!made.ok()) return made.status();
    if (!*made) {
      Stop();
      break;
    }
    absl::Status taught = TeachStablePose(id);
    if (absl::IsFailedPrecondition(taught)) {
      prompt_.Print(std::string(taught.message()));
      continue;
    }
    if (!taught.ok()) return taught;
  }
  return counts_;
}

absl::Status GuidedTeaching::Begin() {
  RETURN_IF_ERROR(TurntableCoverage::Create(options_.step_deg).status());
  ASSIGN_OR_RETURN(const Eigen::Vector2d axis, AxisOf(options_));
  origin_ = Eigen::Vector3d(axis.x(), axis.y(), 0);
  RETURN_IF_ERROR(taker_.Check());
  v1::CapturedObject object;
  object.set_object_id(options_.object_id);
  object.set_display_name(options_.display_name);
  RETURN_IF_ERROR(CreateParents(client_, {object}));
  prompt_.Print(absl::StrCat("put the object on the middle of the turntable, whose axis is at x ",
                             axis.x(), ", y ", axis.y(), " m, and turn it ",
                             options_.clockwise ? "clockwise" : "counter-clockwise",
                             " as seen from above"));
  return absl::OkStatus();
}

absl::StatusOr<TurntableCoverage> GuidedTeaching::CoverageOf(const std::string& stable_pose_id) {
  ASSIGN_OR_RETURN(const auto views,
                   client_.ListViews(StablePoseName(options_.object_id, stable_pose_id)));
  ASSIGN_OR_RETURN(TurntableCoverage coverage, TurntableCoverage::Create(options_.step_deg));
  RETURN_IF_ERROR(coverage.Add(views, origin_, options_.clockwise));
  return coverage;
}

absl::StatusOr<std::string> GuidedTeaching::ProposeStablePose() {
  ASSIGN_OR_RETURN(const auto poses, client_.ListStablePoses("objects/" + options_.object_id));
  std::set<std::string> ids;
  std::string unfinished;
  for (const v1::StablePose& pose : poses) {
    const std::string id = pose.name().substr(pose.name().rfind('/') + 1);
    ids.insert(id);
    ASSIGN_OR_RETURN(const auto left, LeftByMove(client_, pose.name(), origin_));
    if (!left.empty() && !visited_.contains(id)) {
      prompt_.Print(absl::StrCat(id, " has views about two axes"));
      if (unfinished.empty()) unfinished = id;
    }
    const absl::StatusOr<TurntableCoverage> coverage = CoverageOf(id);
    if (absl::IsFailedPrecondition(coverage.status())) continue;  // taught in another way
    if (!coverage.ok()) return coverage.status();
    if (!visited_.contains(id)) prompt_.Print(absl::StrCat(id, " ", coverage->Ring()));
    if (unfinished.empty() && !visited_.contains(id) && !coverage->Missing().empty()) {
      unfinished = id;
    }
  }
  if (!unfinished.empty()) return unfinished;
  int number = 1;
  while (ids.contains(absl::StrCat("pose-", number))) ++number;
  return absl::StrCat("pose-", number);
}

absl::StatusOr<std::string> GuidedTeaching::PromptForStablePose() {
  ASSIGN_OR_RETURN(std::string proposed, ProposeStablePose());
  const std::optional<std::string> answer = prompt_.ReadLine(
      absl::StrCat(kStablePosePrompt, " (Enter: ", proposed, ", done: that was all) "));
  if (!answer) Stop();
  if (!answer) return "";
  const std::string word(absl::StripAsciiWhitespace(*answer));
  if (word == "q") Stop();
  if (word == "q" || word == "done") return "";
  return word.empty() ? proposed : word;
}

absl::StatusOr<bool> GuidedTeaching::MakeStablePose(const std::string& id) {
  const auto there = client_.GetStablePose(StablePoseName(options_.object_id, id));
  if (there.ok()) return true;
  if (!absl::IsNotFound(there.status())) return there.status();
  int order = -1;
  while (order < 0) {
    const std::optional<std::string> answer = prompt_.ReadLine(
        "after which turns about the vertical does it look the same? (Enter: none, 2: half a turn, "
        "4: a quarter, …, any: any turn) ");
    if (!answer) return false;
    const std::string word(absl::StripAsciiWhitespace(*answer));
    if (word == "q") return false;
    order = SymmetryOrder(word);
    if (order < 0) prompt_.Print("answer Enter, \"any\" or a number of 2 to 360");
  }
  if (order != 1) {
    prompt_.Print(
        "put its axis of symmetry on the axis of the turntable, within a millimetre or two");
  }
  v1::CapturedObject object;
  object.set_object_id(options_.object_id);
  v1::CapturedStablePose* pose = object.add_stable_poses();
  pose->set_stable_pose_id(id);
  pose->set_symmetry_order(order);
  RETURN_IF_ERROR(CreateParents(client_, {object}));
  return true;
}

absl::Status GuidedTeaching::TeachStablePose(const std::string& id) {
  visited_.insert(id);
  RETURN_IF_ERROR(
      OfferToEndMove(client_, prompt_, StablePoseName(options_.object_id, id), origin_));
  ASSIGN_OR_RETURN(TurntableCoverage coverage, CoverageOf(id));
  TurnDialogue turn(taker_, client_, prompt_, coverage,
                    {.stable_pose = StablePoseName(options_.object_id, id),
                     .origin = origin_,
                     .clockwise = options_.clockwise});
  if (!turn.Run()) Stop();
  counts_.taught += turn.taught();
  const std::string missing = coverage.MissingText();
  prompt_.Print(absl::StrCat(id, " ", coverage.Ring(),
                             missing.empty() ? "" : absl::StrCat(", missing: ", missing)));
  if (turn.taught() == 0) return absl::OkStatus();
  RETURN_IF_ERROR(CheckAxis(id));
  return WarnOfLookAlikes();
}

absl::Status GuidedTeaching::CheckAxis(const std::string& id) {
  ASSIGN_OR_RETURN(auto views, TaughtTurn(client_, StablePoseName(options_.object_id, id)));
  const Eigen::Vector2d given = origin_.head<2>();
  const absl::StatusOr<SeenAxis> seen = FindAxis(views, given);
  for (TurnedCloud& view : views) view.azimuth_rad = -view.azimuth_rad;
  const absl::StatusOr<SeenAxis> mirrored = FindAxis(views, given);
  if (mirrored.ok() && mirrored->share > kTurnedTheOtherWay + (seen.ok() ? seen->share : 0)) {
    prompt_.Print(absl::StrCat("note: it seems to have been turned the other way; delete ", id,
                               " and teach it again ", options_.clockwise ? "without" : "with",
                               " --clockwise"));
    return absl::OkStatus();
  }
  if (!seen.ok()) return absl::OkStatus();  // the views do not determine the axis
  return (seen->axis - given).norm() < kAxisOffM ? absl::OkStatus() : OfferAxis(id, seen->axis);
}

absl::Status GuidedTeaching::OfferAxis(const std::string& id, const Eigen::Vector2d& axis) {
  const std::string text = absl::StrFormat("%.4f,%.4f", axis.x(), axis.y());
  prompt_.Print(
      absl::StrFormat("note: the views fit together about the axis %s, %.1f mm from the given one",
                      text, 1000 * (axis - origin_.head<2>()).norm()));
  const std::optional<std::string> answer =
      prompt_.ReadLine("use that axis for them and for later views? (Enter: yes, n: no) ");
  if (!answer) Stop();
  if (!answer || !absl::StripAsciiWhitespace(*answer).empty()) {
    prompt_.Print(absl::StrCat(id, " keeps its axis; its views do not fit together"));
    return absl::OkStatus();
  }
  RETURN_IF_ERROR(
      MoveTurn(client_, StablePoseName(options_.object_id, id), axis, RegionOf(options_)));
  origin_.head<2>() = axis;
  prompt_.Print(absl::StrCat("done; when you teach on this turntable again, give --axis ", text));
  return absl::OkStatus();
}

absl::Status GuidedTeaching::WarnOfLookAlikes() {
  ASSIGN_OR_RETURN(const v1::CatalogStatus status, client_.GetCatalogStatus());
  if (status.stable_pose_count() > kComparedStablePoses) {
    prompt_.Print("find look-alikes with: graspdb objects check");
    return absl::OkStatus();
  }
  ASSIGN_OR_RETURN(const auto found, client_.FindLookAlikes("objects/" + options_.object_id));
  for (const std::string& text : LookAlikesText(found, /*nearly_too=*/true)) {
    prompt_.Print(absl::StrCat("note: ", text));
  }
  return absl::OkStatus();
}

}  // namespace graspdb::client
