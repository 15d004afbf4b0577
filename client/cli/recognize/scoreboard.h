// The table that `recognize` prints, with a summary at the end.
#pragma once

#include <optional>

#include "client/cli/recognize/scan_source.h"
#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::client {

// A response compared with the ground truth.
struct Verdict {
  bool object_right = false;
  bool pose_right = false;                   // IsRight
  std::optional<double> add_s_m;             // where the shape is known
  std::optional<double> rotation_error_deg;  // modulo symmetry
  std::optional<double> translation_error_m;
};

// The detection to compare: the nearest to the true position of the object, or the first
// without ground truth. Null without detections.
const v1::Detection* MainDetection(const ScanTask& task, const v1::RecognizeResponse& response);

// Empty for a scan without ground truth.
std::optional<Verdict> Judge(const ScanTask& task, const v1::RecognizeResponse& response);

// Prints a line per scan and a summary. Not thread-safe.
class Scoreboard {
 public:
  static void PrintHeader();
  void Add(const ScanTask& task, const v1::RecognizeResponse& response);
  // The mean time, and with ground truth the shares of correct results.
  void PrintSummary() const;

 private:
  int judged_ = 0;
  int objects_right_ = 0;
  int poses_measured_ = 0;
  int poses_right_ = 0;
  double total_ms_ = 0;
  int answers_ = 0;
};

}  // namespace graspdb::client
