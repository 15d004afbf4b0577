#include "server/recognition/frame_recognizer.h"

#include <chrono>

#include "absl/status/status.h"
#include "base/status_macros.h"
#include "server/base/errors.h"
#include "server/recognition/answer.h"
#include "server/requests/convert.h"

namespace graspdb::server {
namespace {

using Clock = std::chrono::steady_clock;

double MillisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// A request, unpacked and checked, with the settings of its cell.
struct Job {
  recognition::Scan scan;
  recognition::RecognitionParameters parameters;
  bool sensor_pose_from_cell = false;
  Visibility visibility = {};
};

// Applies the settings of the cell or the request; `path` is the prefix of the
// fields' names ("cell." or empty).
template <typename Source>
absl::Status ApplySettings(const Source& source, const std::string& path, Job* job) {
  if (source.has_sensor_pose()) {
    ASSIGN_OR_RETURN(job->scan.world_sensor,
                     PoseFromProto(source.sensor_pose(), path + "sensor_pose"));
  }
  if (source.has_region_of_interest()) {
    ASSIGN_OR_RETURN(job->scan.region,
                     BoxFromProto(source.region_of_interest(), path + "region_of_interest"));
  }
  return ApplyPipeline(source.pipeline(), path + "pipeline", &job->parameters);
}

absl::Status ApplyCell(const storage::Catalogue& catalogue, const std::string& name, Job* job) {
  if (name.empty()) return absl::OkStatus();
  absl::StatusOr<v1::Cell> cell = catalogue.GetCell(name);
  if (!cell.ok()) return AtField("cell", cell.status());
  RETURN_IF_ERROR(ApplySettings(*cell, "cell.", job));
  job->sensor_pose_from_cell = cell->has_sensor_pose();
  job->visibility = {cell->include_drafts(), {cell->labels().begin(), cell->labels().end()}};
  if (cell->has_workspace()) {
    ASSIGN_OR_RETURN(job->parameters.workspace, BoxFromProto(cell->workspace(), "cell.workspace"));
  }
  return absl::OkStatus();
}

}  // namespace

FrameRecognizer::FrameRecognizer(const storage::Catalogue& catalogue, const LiveCatalogue& live,
                                 recognition::ViewClouds& clouds,
                                 const recognition::RecognitionParameters& parameters,
                                 std::size_t max_points)
    : catalogue_(catalogue),
      live_(live),
      clouds_(clouds),
      parameters_(parameters),
      max_points_(max_points) {}

absl::StatusOr<v1::RecognizeResponse> FrameRecognizer::Answer(
    const v1::RecognizeRequest& request, const recognition::IsCancelled& is_cancelled) {
  const Clock::time_point start = Clock::now();
  Job job;
  job.parameters = parameters_;
  RETURN_IF_ERROR(ApplyCell(catalogue_, request.cell(), &job));
  RETURN_IF_ERROR(ApplySettings(request, "", &job));
  job.parameters.matching.use_own_min_scores = !request.pipeline().has_min_score();
  job.scan.segmented = request.segmented();
  RETURN_IF_ERROR(ReadScan(request, max_points_, &job.scan));

  AnswerContext context;
  context.catalog_id = catalogue_.id();
  context.sensor_pose_from_cell = job.sensor_pose_from_cell && !request.has_sensor_pose();
  context.decode_ms = MillisecondsSince(start);
  using Response = absl::StatusOr<v1::RecognizeResponse>;
  const auto recognize = [&](const recognition::CatalogueSnapshot& snapshot) -> Response {
    ASSIGN_OR_RETURN(const auto result, recognition::Recognize(job.scan, snapshot, clouds_,
                                                               job.parameters, is_cancelled));
    context.total_ms = MillisecondsSince(start);
    return MakeAnswer(result, snapshot, context);
  };
  return live_.WithSnapshot(job.visibility, recognize);
}

}  // namespace graspdb::server
