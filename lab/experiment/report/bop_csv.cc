#include "lab/experiment/report/bop_csv.h"

#include <algorithm>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "lab/experiment/report/case_figures.h"

namespace graspdb::lab {
namespace {

constexpr char kBopHeader[] = "scene_id,im_id,obj_id,score,R,t,time\n";
constexpr int kSceneId = 1;
constexpr char kBopMethod[] = "graspdb_";
constexpr char kBopEnd[] = "-test.csv";

std::string RotationText(const Eigen::Matrix3d& rotation) {
  std::string out;
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index column = 0; column < 3; ++column) {
      absl::StrAppendFormat(&out, "%s%.9g", out.empty() ? "" : " ", rotation(row, column));
    }
  }
  return out;
}

// As a CSV field; object ids hold neither quotes nor commas today, but a file of other programs
// must not break when they do.
std::string Field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  return absl::StrCat("\"", absl::StrReplaceAll(text, {{"\"", "\"\""}}), "\"");
}

std::string BopLine(std::size_t image, std::size_t object, double score,
                    const recognition::Pose& camera_object, double milliseconds) {
  const Eigen::Vector3d t = camera_object.translation() * 1e3;
  return absl::StrFormat("%d,%d,%d,%.9g,%s,%.9g %.9g %.9g,%.6f\n", kSceneId, image, object, score,
                         RotationText(camera_object.linear()), t.x(), t.y(), t.z(),
                         milliseconds / 1e3);
}

}  // namespace

std::string BopFileName(const std::string& case_name) {
  const std::string dataset = absl::StrReplaceAll(case_name, {{"-", ""}, {"_", ""}});
  return absl::StrCat(kBopMethod, dataset, kBopEnd);
}

bool IsBopFileName(const std::string& name) {
  return name.starts_with(kBopMethod) && name.ends_with(kBopEnd);
}

std::string BopCsv(const CaseResult& result) {
  std::string out = kBopHeader;
  for (const Answer& a : result.answers) {
    const std::optional<std::size_t> part = PartOfFound(a, result.set);
    if (!part) continue;
    out += BopLine(a.scene, *part + 1, a.score, a.world_sensor.inverse() * a.found, a.milliseconds);
  }
  return out;
}

std::string BopObjectsHeader() { return "case,obj_id,object,stable_pose\n"; }

std::string BopObjects(const CaseResult& result) {
  std::string out;
  for (std::size_t i = 0; i < result.set.parts.size(); ++i) {
    const rendering::Workpiece& part = result.set.parts[i];
    absl::StrAppend(&out, Field(result.experiment.name), ",", i + 1, ",", Field(part.object_id),
                    ",", Field(part.stable_pose_id), "\n");
  }
  return out;
}

std::string BopCsv(const std::vector<FrameResult>& results,
                   const std::vector<std::string>& object_ids) {
  std::string out = kBopHeader;
  for (std::size_t i = 0; i < results.size(); ++i) {
    for (const FrameDetection& d : results[i].detections) {
      const auto object = std::ranges::find(object_ids, d.object) - object_ids.begin();
      out += BopLine(i, static_cast<std::size_t>(object) + 1, d.score, d.sensor_mesh,
                     results[i].milliseconds);
    }
  }
  return out;
}

std::string BopObjects(const std::vector<std::string>& object_ids) {
  std::string out = BopObjectsHeader();
  for (std::size_t i = 0; i < object_ids.size(); ++i) {
    absl::StrAppend(&out, kBopFrames, ",", i + 1, ",", Field(object_ids[i]), ",\n");
  }
  return out;
}

}  // namespace graspdb::lab
