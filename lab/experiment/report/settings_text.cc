#include "lab/experiment/report/settings_text.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"

namespace graspdb::lab {
namespace {

std::string StandText(const Stand& stand) {
  std::string out = absl::StrFormat("%s %.2g m away, looking down %s°", CameraName(stand.camera),
                                    stand.distance_m, absl::StrJoin(stand.look_down_deg, "°, "));
  if (stand.camera.noise.scale != 1) {
    absl::StrAppendFormat(&out, ", its noise times %.2g", stand.camera.noise.scale);
  }
  return out;
}

}  // namespace

std::string CameraName(const rendering::DepthCameraModel& camera) {
  const auto is = [&](const rendering::DepthCameraModel& other) {
    return camera.intrinsics.width == other.intrinsics.width &&
           camera.intrinsics.height == other.intrinsics.height &&
           camera.intrinsics.fx == other.intrinsics.fx;
  };
  if (is(rendering::KinectV1())) return "Kinect v1";
  return is(rendering::KinectV2()) ? "Kinect v2" : "other camera";
}

std::string SettingsText(const CaseResult& result) {
  const ExperimentCase& e = result.experiment;
  if (!e.settings.empty()) return e.settings;
  std::string out =
      absl::StrFormat("Taught: %d of %d parts at the centre, every %.3g°; %s. Queried: %s; ",
                      result.set.taught_count, result.set.parts.size(), e.teach_step_deg,
                      StandText(e.taught), StandText(e.queried));
  if (e.between_taught_azimuths) {
    absl::StrAppend(&out, "at the centre, at azimuths between the taught ones.");
  } else {
    absl::StrAppendFormat(&out, "anywhere within ±%.2g m, at any azimuth, %d scenes for each part.",
                          e.area_half_width_m, e.trials_per_part);
  }
  if (e.objects_per_scene > 1) {
    absl::StrAppendFormat(&out, " %d objects stand %.2g cm apart in a scene.", e.objects_per_scene,
                          100 * e.gap_m);
  }
  if (e.hidden_share > 0) {
    absl::StrAppendFormat(&out, " An obstacle hides %.3g %% of the object.", 100 * e.hidden_share);
  }
  absl::StrAppend(&out, " Seed ", e.seed, ".");
  return out;
}

}  // namespace graspdb::lab
