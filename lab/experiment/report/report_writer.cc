#include "lab/experiment/report/report_writer.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "files/atomic_file.h"
#include "lab/experiment/report/bop_csv.h"
#include "lab/experiment/report/case_section.h"
#include "lab/experiment/report/descriptor_section.h"
#include "lab/experiment/report/figure_files.h"
#include "lab/experiment/report/report_json.h"
#include "lab/experiment/report/report_markdown.h"

namespace graspdb::client {
namespace {

absl::Status WriteFile(const std::filesystem::path& path, const std::string& text) {
  return WriteFileAtomically(path, text, Durability::kProcessCrash);
}

}  // namespace

ReportWriter::ReportWriter(std::filesystem::path folder, const std::string& command)
    : folder_(std::move(folder)),
      page_{.command = command, .rows = {}, .sections = {}, .descriptors = {}},
      bop_objects_(BopObjectsHeader()) {}

absl::StatusOr<ReportWriter> ReportWriter::Create(const std::filesystem::path& folder,
                                                  const std::string& command) {
  std::error_code unknown;  // what cannot be looked at cannot be written either, and says so there
  if (std::filesystem::exists(folder, unknown) && !std::filesystem::is_directory(folder, unknown)) {
    return absl::FailedPreconditionError(
        absl::StrCat(folder.string(), " is a file; the report needs a folder, name another one"));
  }
  ReportWriter writer(folder, command);
  if (absl::Status written = writer.Write(); !written.ok()) return written;
  return writer;
}

absl::Status ReportWriter::Add(const CaseResult& result) {
  page_.rows.push_back(RowOf(result));
  page_.sections.push_back(CaseSection(result));
  json_.push_back(CaseAsJson(result));
  absl::StrAppend(&bop_objects_, BopObjects(result));
  absl::Status written = WriteFile(folder_ / BopFileName(result.experiment), BopCsv(result));
  written.Update(WriteFigures(result.experiment.name, page_.sections.back()));
  return written.ok() ? Write() : written;
}

absl::Status ReportWriter::SetDescriptors(std::vector<DescriptorFigures> figures) {
  page_.descriptors = std::move(figures);
  absl::Status written =
      WriteFile(folder_ / "descriptors.md", TableMarkdown(DescriptorTable(page_.descriptors)));
  written.Update(WriteFigures("descriptors", DescriptorSection(page_.descriptors)));
  return written.ok() ? Write() : written;
}

absl::Status ReportWriter::WriteFigures(const std::string& section,
                                        const std::string& markup) const {
  for (const FigureFile& figure : FigureFiles(section, markup)) {
    absl::Status written = WriteFile(folder_ / "figures" / figure.name, figure.svg);
    if (!written.ok()) return written;
  }
  return absl::OkStatus();
}

absl::Status ReportWriter::Write() const {
  auto json = ReportJson(page_.command, json_);
  if (!json.ok()) return json.status();
  absl::Status status = WriteFile(folder_ / "report.json", *json);
  status.Update(WriteFile(folder_ / "bop_objects.csv", bop_objects_));
  status.Update(WriteFile(folder_ / "cases.md", TableMarkdown(CaseTable(page_.rows))));
  status.Update(WriteFile(page_path(), ReportHtml(page_)));
  return status;
}

}  // namespace graspdb::client
