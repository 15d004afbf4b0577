// The files of an experiment, and of a run on frames of real cameras.
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
#include "lab/experiment/report/case_figures.h"

namespace graspdb::lab {

// Answers in the format in which the BOP challenge takes results:
// https://bop.felk.cvut.cz/challenges/bop-challenge-2019, "How to participate"; the BOP toolkit
// reads it with load_bop_results.

// "graspdb_hidden20-test.csv" for the case "hidden-20": METHOD_DATASET-SPLIT.csv. The toolkit cuts
// the name at '_' and '-', so that the case's own ones go.
std::string BopFileName(const std::string& case_name);

// "scene_id,im_id,obj_id,score,R,t,time" and a line for each answer that names a stable pose.
// scene_id is 1, im_id the number of the query. R (row by row) and t (mm) are T_camera_object,
// camera: x right, y down, z forward; object: the frame of the workpiece's mesh as it rests. time:
// seconds for the whole image, so that all its lines have the same.
std::string BopCsv(const CaseResult& result);

// "case,obj_id,object,stable_pose" for each part; every case numbers its parts from 1. Without the
// line of the headings.
std::string BopObjects(const CaseResult& result);

// The same of frames of real cameras, whose case is "frames", and with the headings. im_id is the
// position of the frame in `results`, from 0, and obj_id that of the object in `object_ids`,
// from 1. R and t are T_camera_mesh, of the mesh as its file has it.
std::string BopCsv(const std::vector<FrameResult>& results,
                   const std::vector<std::string>& object_ids);
std::string BopObjects(const std::vector<std::string>& object_ids);

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

// How many true poses came as far as each stage, first the headings: of frames whose arrangement is
// "separated" in words, of the others, of all, and what segments and the search in the image
// alone did for all. What an accepted answer of a segment explains is not searched for.
std::vector<std::vector<std::string>> StageTable(const std::vector<FrameResult>& results);

// Writes into `folder`, which exists:
//   report.json                FramesJson
//   stages.md                  StageTable, for documents
//   graspdb_frames-test.csv    the accepted poses as the BOP challenge takes them
//   bop_objects.csv            the numbers of the objects in it
// Errors as FramesJson and WriteFileAtomically.
absl::Status WriteFramesReport(const std::filesystem::path& folder, const std::string& command,
                               const std::vector<std::string>& object_ids,
                               const std::vector<FrameResult>& results);

}  // namespace graspdb::lab
