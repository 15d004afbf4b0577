#include "lab/experiment/report/report_writer.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <system_error>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "base/status_macros.h"
#include "files/base/atomic_file.h"
#include "lab/experiment/report/report_json.h"

namespace graspdb::lab {
namespace {

// The case of frames of real cameras.
constexpr char kBopFrames[] = "frames";
constexpr char kBopObjectsHeader[] = "case,obj_id,object,stable_pose\n";
constexpr char kBopHeader[] = "scene_id,im_id,obj_id,score,R,t,time\n";
constexpr int kSceneId = 1;
constexpr char kBopMethod[] = "graspdb_";
constexpr char kBopEnd[] = "-test.csv";

// Whether it may be the name of a file of BopFileName(), of any case.
bool IsBopFileName(const std::string& name) {
  return name.starts_with(kBopMethod) && name.ends_with(kBopEnd);
}

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

constexpr char kSeparated[] = "separated";

using StageOf = std::function<PoseStage(const FrameInstance&)>;
using IsCounted = std::function<bool(const FrameResult&)>;

std::string CountOf(const std::vector<FrameResult>& results, PoseStage reached,
                    const IsCounted& is_counted, const StageOf& stage_of) {
  std::ptrdiff_t count = 0;
  for (const FrameResult& result : results) {
    if (!is_counted(result)) continue;
    count += std::ranges::count_if(result.instances,
                                   [&](const FrameInstance& i) { return stage_of(i) >= reached; });
  }
  return absl::StrCat(count);
}

constexpr char kReportFile[] = "report.json";
constexpr char kDescriptorsFile[] = "descriptors.md";
constexpr char kPageFile[] = "report.html";  // of graspdb-eval-report

absl::Status WriteFile(const std::filesystem::path& path, const std::string& text) {
  return files::WriteFileAtomically(path, text, files::Durability::kProcessCrash);
}

// Poses and descriptors of an earlier report: of cases that this one lacks, with other numbers of
// objects.
absl::Status RemoveEarlier(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder / kReportFile, error)) return absl::OkStatus();
  std::vector<std::filesystem::path> earlier = {folder / kDescriptorsFile, folder / kPageFile};
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    if (IsBopFileName(at->path().filename().string())) earlier.push_back(at->path());
  }
  for (const std::filesystem::path& path : earlier) {
    if (!error) std::filesystem::remove(path, error);
  }
  if (!error) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat("the earlier report in ", folder.string(),
                                                    " cannot be removed: ", error.message(),
                                                    "; name another folder"));
}

}  // namespace

std::string BopFileName(const std::string& case_name) {
  const std::string dataset = absl::StrReplaceAll(case_name, {{"-", ""}, {"_", ""}});
  return absl::StrCat(kBopMethod, dataset, kBopEnd);
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
  std::string out = kBopObjectsHeader;
  for (std::size_t i = 0; i < object_ids.size(); ++i) {
    absl::StrAppend(&out, kBopFrames, ",", i + 1, ",", Field(object_ids[i]), ",\n");
  }
  return out;
}

ReportWriter::ReportWriter(std::filesystem::path folder, const std::string& command)
    : folder_(std::move(folder)), command_(command), bop_objects_(kBopObjectsHeader) {}

absl::StatusOr<ReportWriter> ReportWriter::Create(const std::filesystem::path& folder,
                                                  const std::string& command) {
  std::error_code unknown;  // a folder that cannot be read cannot be written either: reported there
  if (std::filesystem::exists(folder, unknown) && !std::filesystem::is_directory(folder, unknown)) {
    return absl::FailedPreconditionError(
        absl::StrCat(folder.string(), " is a file; the report needs a folder, name another one"));
  }
  RETURN_IF_ERROR(RemoveEarlier(folder));
  ReportWriter writer(folder, command);
  RETURN_IF_ERROR(writer.Write());
  return writer;
}

absl::Status ReportWriter::Add(const CaseResult& result) {
  rows_.push_back(RowOf(result));
  cases_.push_back(CaseAsJson(result));
  absl::StrAppend(&bop_objects_, BopObjects(result));
  RETURN_IF_ERROR(WriteFile(folder_ / BopFileName(result.experiment.name), BopCsv(result)));
  return Write();
}

absl::Status ReportWriter::SetDescriptors(std::vector<DescriptorFigures> figures) {
  descriptors_ = std::move(figures);
  RETURN_IF_ERROR(
      WriteFile(folder_ / kDescriptorsFile, TableMarkdown(DescriptorTable(descriptors_))));
  return Write();
}

absl::Status ReportWriter::Write() const {
  ASSIGN_OR_RETURN(auto json, ReportJson(command_, descriptors_, cases_));
  absl::Status status = WriteFile(folder_ / kReportFile, json);
  status.Update(WriteFile(folder_ / "bop_objects.csv", bop_objects_));
  status.Update(WriteFile(folder_ / "cases.md", TableMarkdown(CaseTable(rows_))));
  return status;
}

std::vector<std::vector<std::string>> StageTable(const std::vector<FrameResult>& results) {
  const auto separated = [](const FrameResult& r) {
    return absl::StrContains(r.frame->arrangement, kSeparated);
  };
  const auto other = [&](const FrameResult& r) { return !separated(r); };
  const auto all = [](const FrameResult&) { return true; };
  std::vector<std::vector<std::string>> table = {
      {"true poses", kSeparated, "other", "all", "by segments", "in the image"}};
  for (const PoseStage stage : kPoseStages) {
    const auto count = [&](const IsCounted& is_counted, const StageOf& stage_of) {
      return CountOf(results, stage, is_counted, stage_of);
    };
    const auto stage_of = &FrameInstance::stage;
    // Either source alone comes as far as the best of an object.
    const bool of_both = stage == PoseStage::kNone || stage == PoseStage::kAccepted;
    table.push_back({stage == PoseStage::kNone ? "all" : TextOf(stage), count(separated, stage_of),
                     count(other, stage_of), count(all, stage_of),
                     of_both ? "" : count(all, &FrameInstance::by_segments),
                     of_both ? "" : count(all, &FrameInstance::in_image)});
  }
  return table;
}

absl::Status WriteFramesReport(const std::filesystem::path& folder, const std::string& command,
                               const std::vector<std::string>& object_ids,
                               const std::vector<FrameResult>& results) {
  ASSIGN_OR_RETURN(const auto json, FramesJson(command, results));
  absl::Status status;
  const auto write = [&](const std::string& name, const std::string& text) {
    status.Update(
        files::WriteFileAtomically(folder / name, text, files::Durability::kProcessCrash));
  };
  write("report.json", json);
  write("stages.md", TableMarkdown(StageTable(results)));
  write(BopFileName(kBopFrames), BopCsv(results, object_ids));
  write("bop_objects.csv", BopObjects(object_ids));
  return status;
}

}  // namespace graspdb::lab
