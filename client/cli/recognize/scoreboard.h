// The table that `recognize` prints for people, and its sum at the end.
#pragma once

#include <optional>

#include "client/cli/recognize/scan_source.h"
#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::client {

// An answer held against the truth.
struct Verdict {
  bool object_right = false;
  bool pose_right = false;                   // ADD-S under 5 % of the diameter
  std::optional<double> add_s_m;             // where the model is known
  std::optional<double> rotation_error_deg;  // modulo symmetry
  std::optional<double> translation_error_m;
};

// The detection that is meant: the one nearest to where the object truly stands, or
// the first one. Null when there is none.
const v1::Detection* MainDetection(const ScanTask& task, const v1::RecognizeResponse& response);

// Nothing for a scan whose truth is not known.
std::optional<Verdict> Judge(const ScanTask& task, const v1::RecognizeResponse& response);

// Prints a line a scan, and the shares at the end. Not thread-safe.
class Scoreboard {
 public:
  void PrintHeader(bool with_truth);
  void Add(const ScanTask& task, const v1::RecognizeResponse& response);
  // The shares that were right; nothing without truth.
  void PrintSummary() const;

 private:
  bool with_truth_ = false;
  int judged_ = 0;
  int objects_right_ = 0;
  int poses_measured_ = 0;
  int poses_right_ = 0;
  double total_ms_ = 0;
  int answers_ = 0;
};

}  // namespace graspdb::client
