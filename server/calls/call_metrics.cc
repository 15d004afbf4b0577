#include "server/calls/call_metrics.h"

#include <array>
#include <utility>

#include "absl/status/status.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace graspdb::server {
namespace {

// The reason in the details of an error of ours, which is one of a few constants.
std::string ReasonOf(const grpc::Status& status) {
  google::rpc::Status details;
  google::rpc::ErrorInfo info;
  details.ParseFromString(status.error_details());
  for (const google::protobuf::Any& detail : details.details()) {
    if (detail.UnpackTo(&info)) return info.reason();
  }
  return "NONE";
}

// "objects/flange" of "objects/flange/stablePoses/flat".
std::string ObjectOf(const std::string& stable_pose) {
  return stable_pose.substr(0, stable_pose.find("/stablePoses/"));
}

}  // namespace

void CallMetrics::CountCall(std::string_view method, const grpc::Status& status,
                            absl::Duration time) {
  const std::string name(method);
  const auto code = static_cast<absl::StatusCode>(status.error_code());
  calls_.With({name, absl::StatusCodeToString(code)}).Increment();
  call_times_.With({name}).Observe(absl::ToDoubleSeconds(time));
  if (!status.ok()) rejected_.With({ReasonOf(status)}).Increment();
}

void CallMetrics::CountFrame(const std::string& cell, const v1::RecognizeResponse& response,
                             absl::Duration waited) {
  frames_.With({cell, v1::RecognitionStatus_Name(response.status())}).Increment();
  const v1::Timings& timings = response.timings();
  const std::array<std::pair<const char*, double>, 6> steps = {
      {{"queue", absl::ToDoubleMilliseconds(waited)},
       {"decode", timings.decode_ms()},
       {"segment", timings.segment_ms()},
       {"describe", timings.describe_ms()},
       {"match", timings.match_ms()},
       {"register", timings.register_ms()}}};
  for (const auto& [step, ms] : steps) step_times_.With({step}).Observe(ms / 1000);
  // A share of unknown objects is 0, and not absent, before the first one: alerts compare it.
  detections_.With({cell, v1::RecognitionStatus_Name(v1::UNKNOWN_OBJECT)});
  for (const v1::Detection& detection : response.detections()) {
    detections_.With({cell, v1::RecognitionStatus_Name(detection.status())}).Increment();
    if (detection.status() == v1::UNKNOWN_OBJECT) {
      unknown_.With({v1::RejectionGate_Name(detection.rejected_by())}).Increment();
    }
    if (!detection.object().empty()) scores_.With({}).Observe(detection.score());
  }
}

void CallMetrics::CountPicks(const std::string& cell,
                             const v1::ReportGraspOutcomeRequest& request) {
  const std::string object = ObjectOf(request.name());
  for (const v1::GraspOutcome outcome :
       {v1::GRASP_OUTCOME_PICKED, v1::GRASP_OUTCOME_MISSED, v1::GRASP_OUTCOME_SLIPPED}) {
    picks_.With({cell, object, v1::GraspOutcome_Name(outcome)});  // at 0 before the first one
  }
  picks_.With({cell, object, v1::GraspOutcome_Name(request.outcome())})
      .Increment(request.has_count() ? request.count() : 1);
}

MetricFamilies CallMetrics::Collect() const {
  return {calls_.Collect(),      rejected_.Collect(), call_times_.Collect(),
          step_times_.Collect(), frames_.Collect(),   detections_.Collect(),
          unknown_.Collect(),    scores_.Collect(),   picks_.Collect()};
}

}  // namespace graspdb::server
