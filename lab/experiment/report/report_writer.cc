#include "lab/experiment/report/report_writer.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/base/atomic_file.h"
#include "lab/experiment/report/report_json.h"

namespace graspdb::lab {
namespace {

constexpr char kProgram[] = "graspdb-eval-report";
constexpr char kReportFile[] = "report.json";

// Whether graspdb-eval-report may have made a file of this name from report.json.
bool IsMade(const std::string& name) {
  constexpr std::array<std::string_view, 5> kMade = {"report.html", "cases.md", "descriptors.md",
                                                     "stages.md", "bop_objects.csv"};
  return std::ranges::find(kMade, name) != kMade.end() ||
         (name.starts_with("graspdb_") && name.ends_with("-test.csv"));
}

absl::Status WriteReport(const std::filesystem::path& folder, const std::string& json) {
  return files::WriteFileAtomically(folder / kReportFile, json, files::Durability::kProcessCrash);
}

absl::Status RemoveEarlier(const std::filesystem::path& folder) {
  std::error_code error;
  if (!std::filesystem::exists(folder / kReportFile, error)) return absl::OkStatus();
  std::vector<std::filesystem::path> earlier;
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    if (IsMade(at->path().filename().string())) earlier.push_back(at->path());
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

ReportWriter::ReportWriter(std::filesystem::path folder, const std::string& command)
    : folder_(std::move(folder)), command_(command) {}

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
  cases_.push_back(CaseAsJson(result));
  return Write();
}

absl::Status ReportWriter::SetDescriptors(std::vector<DescriptorFigures> figures) {
  descriptors_ = std::move(figures);
  return Write();
}

absl::Status ReportWriter::Write() const {
  ASSIGN_OR_RETURN(const auto json, ReportJson(command_, descriptors_, cases_));
  return WriteReport(folder_, json);
}

absl::Status WriteFramesReport(const std::filesystem::path& folder, const std::string& command,
                               const std::vector<std::string>& object_ids,
                               const std::vector<FrameResult>& results) {
  RETURN_IF_ERROR(RemoveEarlier(folder));
  ASSIGN_OR_RETURN(const auto json, FramesJson(command, object_ids, results));
  return WriteReport(folder, json);
}

absl::Status MakeReportPage(const std::filesystem::path& folder) {
  std::error_code unknown;  // the program is then not found
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", unknown);
  std::string program = here.parent_path() / kProgram;
  std::string argument = folder.string();
  const std::array<char*, 3> arguments = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  int status = 0;
  if (posix_spawn(&child, program.c_str(), nullptr, nullptr, arguments.data(), environ) == 0 &&
      waitpid(child, &status, 0) == child && status == 0) {
    return absl::OkStatus();
  }
  return absl::UnavailableError(
      absl::StrCat(kProgram,
                   " did not end well; install python3 and python3-matplotlib if they are missing, "
                   "then run: ",
                   kProgram, " ", folder.string()));
}

}  // namespace graspdb::lab
