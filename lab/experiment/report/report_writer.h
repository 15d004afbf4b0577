// The files of an experiment.
#pragma once

#include <google/protobuf/struct.pb.h>

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "lab/experiment/descriptor_comparison.h"
#include "lab/experiment/experiment.h"
#include "lab/experiment/report/case_figures.h"

namespace graspdb::lab {

// Writes into one folder, again after every case, so that a run that is interrupted leaves what was
// done:
//   report.json              everything; the program graspdb-eval-report makes report.html and
//                            figures/ from it
//   cases.md                 the table of cases, for documents; descriptors.md where they are
//                            compared
//   graspdb_CASE-test.csv    the poses as the BOP challenge takes them
//   bop_objects.csv          the numbers of the objects in those files
// An earlier report in the folder is replaced, with all its files of these names. The same cases
// give the same bytes, measured times apart.
class ReportWriter {
 public:
  // Makes the folder and writes a report without cases, so that a folder that cannot be written is
  // found before the work. FAILED_PRECONDITION when a file is in the folder's place, or an earlier
  // report cannot be removed; otherwise the errors of WriteFileAtomically.
  static absl::StatusOr<ReportWriter> Create(const std::filesystem::path& folder,
                                             const std::string& command);

  // Appends a case. Errors as WriteFileAtomically and ReportJson.
  absl::Status Add(const CaseResult& result);

  // Adds the comparison of descriptors. Errors as Add.
  absl::Status SetDescriptors(std::vector<DescriptorFigures> figures);

  const std::filesystem::path& folder() const { return folder_; }

 private:
  ReportWriter(std::filesystem::path folder, const std::string& command);

  absl::Status Write() const;

  std::filesystem::path folder_;
  std::string command_;
  std::vector<DescriptorFigures> descriptors_;
  std::vector<CaseRow> rows_;
  std::vector<google::protobuf::Value> cases_;
  std::string bop_objects_;
};

}  // namespace graspdb::lab
