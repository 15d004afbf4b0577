// The files of an experiment.
#pragma once

#include <google/protobuf/struct.pb.h>

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "lab/experiment/experiment.h"
#include "lab/experiment/report/report_html.h"

namespace graspdb::client {

// Writes into one folder, again after every case, so that a run that is interrupted leaves what was
// done:
//   report.html              to be read
//   cases.md                 its table, for documents; descriptors.md where they are compared
//   figures/CASE-TITLE.svg   its plots, for documents
//   report.json              everything, for programs
//   graspdb_CASE-test.csv    the poses as the BOP challenge takes them
//   bop_objects.csv          the numbers of the objects in those files
// What is of the same name is replaced. The same cases give the same bytes, measured times apart.
class ReportWriter {
 public:
  // Makes the folder and writes a report without cases, so that a folder that cannot be written is
  // found before the work. FAILED_PRECONDITION when a file is in the folder's place; otherwise the
  // errors of WriteFileAtomically.
  static absl::StatusOr<ReportWriter> Create(const std::filesystem::path& folder,
                                             const std::string& command);

  // Appends a case. Errors as WriteFileAtomically and ReportJson.
  absl::Status Add(const CaseResult& result);

  // Puts a section about descriptors before the cases. Errors as Add.
  absl::Status SetDescriptors(std::vector<DescriptorFigures> figures);

  std::filesystem::path page_path() const { return folder_ / "report.html"; }

 private:
  ReportWriter(std::filesystem::path folder, const std::string& command);

  absl::Status Write() const;
  absl::Status WriteFigures(const std::string& section, const std::string& markup) const;

  std::filesystem::path folder_;
  ReportPage page_;
  std::vector<google::protobuf::Value> json_;  // of the cases
  std::string bop_objects_;
};

}  // namespace graspdb::client
