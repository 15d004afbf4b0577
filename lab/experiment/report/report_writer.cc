#include "lab/experiment/report/report_writer.h"

#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/base/atomic_file.h"
#include "lab/experiment/report/bop_csv.h"
#include "lab/experiment/report/report_json.h"
#include "lab/experiment/report/report_markdown.h"

namespace graspdb::lab {
namespace {

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

ReportWriter::ReportWriter(std::filesystem::path folder, const std::string& command)
    : folder_(std::move(folder)), command_(command), bop_objects_(BopObjectsHeader()) {}

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

}  // namespace graspdb::lab
