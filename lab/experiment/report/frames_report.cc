#include "lab/experiment/report/frames_report.h"

#include <algorithm>
#include <functional>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/base/atomic_file.h"
#include "lab/experiment/report/bop_csv.h"
#include "lab/experiment/report/report_json.h"
#include "lab/experiment/report/report_markdown.h"

namespace graspdb::lab {
namespace {

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

}  // namespace

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
