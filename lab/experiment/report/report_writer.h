// The report of an experiment, or of a run on frames of real cameras.
#pragma once

#include <google/protobuf/struct.pb.h>

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "lab/experiment/descriptor_comparison.h"
#include "lab/experiment/experiment.h"
#include "lab/experiment/real_frames.h"

namespace graspdb::lab {

// Writes report.json into a folder, again after every case, so that a run that is interrupted
// leaves what was done; the program graspdb-eval-report makes everything else from it: tables,
// poses as the BOP challenge takes them, report.html and figures/.
//
// An earlier report in the folder is removed, with what was made of it, except for figures/. The
// same cases give the same bytes, measured times apart.
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
  std::vector<google::protobuf::Value> cases_;
};

// The report of a run on frames of real cameras, into a folder that exists. Errors as FramesJson
// and WriteFileAtomically.
absl::Status WriteFramesReport(const std::filesystem::path& folder, const std::string& command,
                               const std::vector<std::string>& object_ids,
                               const std::vector<FrameResult>& results);

// Runs graspdb-eval-report, which is beside this program, on the folder and waits for it.
// UNAVAILABLE, with the command for later, where it does not start or fails, e.g. since matplotlib
// is not installed.
absl::Status MakeReportPage(const std::filesystem::path& folder);

}  // namespace graspdb::lab
