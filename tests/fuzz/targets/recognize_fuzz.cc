// Requests of Recognize against two taught parts, one of them fused from views with object poses.
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>

#include "server/live/live_catalogue.h"
#include "server/live/view_cloud_cache.h"
#include "server/recognition/answer.h"
#include "server/recognition/frame_recognizer.h"
#include "storage/catalogue/catalogue.h"
#include "tests/fuzz/fuzz_server.h"
#include "tests/fuzz/message_target.h"
#include "tests/fuzz/requirement.h"

namespace graspdb::fuzz {
namespace {

// The recognition of a server, without gRPC.
class Rig {
 public:
  Rig() {
    server_.TeachParts();
    grpc::ClientContext context;
    v1::CreateCellRequest cell;
    cell.set_cell_id("a");
    v1::Cell made;
    Require(server_.cells().CreateCell(&context, cell, &made).ok(), "a cell is made");
    server_.Stop();
    catalogue_ = storage::Catalogue::Open(server_.database()).value();
    live_ = server::LiveCatalogue::Follow(*catalogue_, parameters_.descriptor).value();
    clouds_.emplace(*catalogue_, parameters_.descriptor, std::size_t{16} << 20U);
    recognizer_.emplace(*catalogue_, *live_, *clouds_, parameters_, kMaxPoints);
  }

  absl::StatusOr<v1::RecognizeResponse> Answer(const v1::RecognizeRequest& request) {
    auto answer = recognizer_->Answer(request, [] { return false; });
    if (answer.ok()) server::LeaveOutTimings(&*answer);
    return answer;
  }

 private:
  FuzzServer server_;
  const recognition::RecognitionParameters parameters_;
  std::unique_ptr<storage::Catalogue> catalogue_;
  std::unique_ptr<server::LiveCatalogue> live_;
  std::optional<server::ViewCloudCache> clouds_;
  std::optional<server::FrameRecognizer> recognizer_;
};

const std::vector<std::string>& Words() {
  static const std::vector<std::string> words = {"cells/a", "cells/b", "cells/", "x",
                                                 "y",       "z",       "rgb",    ""};
  return words;
}

void Check(const v1::RecognizeResponse& response) {
  for (const v1::Detection& detection : response.detections()) {
    Require(detection.score() >= 0 && detection.score() <= 1, "a score from 0 to 1");
    Require(detection.status() != v1::RECOGNITION_STATUS_UNSPECIFIED, "a status");
    if (detection.status() != v1::OK) continue;
    const v1::Vector3& at = detection.refined_pose().position();
    Require(std::isfinite(at.x()) && std::isfinite(at.y()) && std::isfinite(at.z()),
            "a finite pose of a detection");
  }
}

void Run(v1::RecognizeRequest request) {
  static Rig rig;
  const auto response = rig.Answer(request);
  if (!response.ok()) {
    Require(!absl::IsInternal(response.status()) && !absl::IsUnknown(response.status()) &&
                !absl::IsDataLoss(response.status()),
            "an answer or a refusal");
    return;
  }
  Check(*response);
  const auto again = rig.Answer(request);
  Require(again.ok() && again->SerializeAsString() == response->SerializeAsString(),
          "the same scan, the same bytes");
}

}  // namespace
}  // namespace graspdb::fuzz

GRASPDB_FUZZ_MESSAGES(graspdb::v1::RecognizeRequest, graspdb::fuzz::Words(), graspdb::fuzz::Run)
