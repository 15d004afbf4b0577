#include "client/cell/agent/jobs/job_bundle.h"

#include <google/protobuf/util/time_util.h>

#include "client/cell/robots/robot_session.h"
#include "program/version.h"

namespace graspdb::client {

std::optional<v1::Bundle> BundleOf(const JobReport& report, const std::string& server_version) {
  const v1::RecognizeRequest& request = report.capture.request;
  if (!request.has_depth_image() && !request.has_cloud()) return std::nullopt;
  v1::Bundle out;
  *out.mutable_request_time() =
      google::protobuf::util::TimeUtil::NanosecondsToTimestamp(absl::ToUnixNanos(report.start));
  out.set_duration_ms(absl::ToDoubleMilliseconds(report.duration));
  out.set_robot(report.request.session.robot());
  out.set_job(report.request.job);
  out.set_agent_version(kVersion);
  out.set_server_version(server_version);
  out.set_request_id(report.capture.request_id);
  *out.mutable_request() = request;
  out.set_catalog_revision(report.capture.catalog_revision);
  const absl::Status& answered = report.capture.answered;
  if (answered.ok()) {
    *out.mutable_response() = report.capture.response;
  } else {
    out.mutable_error()->set_code(static_cast<int>(answered.code()));
    out.mutable_error()->set_message(std::string(answered.message()));
  }
  return out;
}

}  // namespace graspdb::client
