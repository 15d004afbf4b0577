#include "client/cell/blackbox/replay.h"

#include <google/protobuf/util/message_differencer.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "client/sdk/earlier_servers.h"
#include "recognition/base/units.h"

namespace graspdb::client {
namespace {

using recognition::kDegreesPerRadian;
using recognition::kMmPerM;

// Without fields that vary from run to run.
v1::RecognizeResponse Timeless(v1::RecognizeResponse response) {
  response.clear_timings();
  response.clear_catalog_id();
  response.clear_catalog_revision();
  for (v1::StageReport& stage : *response.mutable_stages()) stage.clear_duration_ms();
  return response;
}

// Whether the server was one of before GraspProposal.grasp: FillGrasps leaves the tool's pose out.
// What such an answer has of a grasp is in the deprecated fields, which are compared.
bool LacksGrasps(const v1::RecognizeResponse& response) {
  return std::ranges::any_of(response.detections(), [](const v1::Detection& detection) {
    return std::ranges::any_of(detection.grasps(), [](const v1::GraspProposal& proposal) {
      return !proposal.grasp().has_tcp_pose();
    });
  });
}

void ClearGrasps(v1::RecognizeResponse* response) {
  for (v1::Detection& detection : *response->mutable_detections()) {
    for (v1::GraspProposal& proposal : *detection.mutable_grasps()) proposal.clear_grasp();
  }
}

std::string NameOf(const v1::Detection& detection) {
  return detection.object().empty() ? "something unknown" : detection.object();
}

std::string PoseDifference(const v1::Pose& then, const v1::Pose& now) {
  const auto position = [](const v1::Vector3& p) { return Eigen::Vector3d(p.x(), p.y(), p.z()); };
  const auto turn = [](const v1::Quaternion& q) {
    return Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z());
  };
  const double shift = (position(now.position()) - position(then.position())).norm();
  const double angle = turn(then.orientation()).angularDistance(turn(now.orientation()));
  return absl::StrFormat("the pose by %.3g mm and %.3g degrees", shift * kMmPerM,
                         angle * kDegreesPerRadian);
}

std::string GraspsOf(const v1::Detection& detection) {
  std::string out;
  for (const v1::GraspProposal& proposal : detection.grasps()) {
    absl::StrAppend(&out, out.empty() ? "" : ", ", TaughtGraspOf(proposal).grasp_id());
  }
  return out.empty() ? "none" : out;
}

bool AreSame(const google::protobuf::Message& a, const google::protobuf::Message& b) {
  return a.SerializeAsString() == b.SerializeAsString();
}

// The first field that differs, as "modified: point_count: 7 -> 8", and the number of the others.
std::string FirstDifference(const google::protobuf::Message& then,
                            const google::protobuf::Message& now) {
  std::string all;
  google::protobuf::util::MessageDifferencer differencer;
  differencer.ReportDifferencesToString(&all);
  differencer.Compare(then, now);
  const std::vector<std::string> lines = absl::StrSplit(all, '\n', absl::SkipEmpty());
  if (lines.empty()) return "the bytes differ, but no value";  // 0 and -0
  if (lines.size() == 1) return lines[0];
  return absl::StrCat(lines[0], " (and ", lines.size() - 1, " more)");
}

void CompareDetections(const std::string& which, const v1::Detection& then,
                       const v1::Detection& now, std::vector<std::string>* out) {
  if (AreSame(then, now)) return;
  const std::size_t before = out->size();
  const auto add = [&](const std::string& what) {
    out->push_back(absl::StrCat(which, ": ", what));
  };
  if (then.object() != now.object()) {
    add(absl::StrCat(NameOf(then), ", now ", NameOf(now)));
  } else if (then.stable_pose() != now.stable_pose()) {
    add(absl::StrCat(then.stable_pose(), ", now ", now.stable_pose()));
  }
  if (then.status() != now.status()) {
    add(absl::StrCat(v1::RecognitionStatus_Name(then.status()), ", now ",
                     v1::RecognitionStatus_Name(now.status())));
  }
  if (!AreSame(then.refined_pose(), now.refined_pose())) {
    add(absl::StrCat(NameOf(now), " differs in ",
                     PoseDifference(then.refined_pose(), now.refined_pose())));
  }
  if (then.score() != now.score()) {
    add(absl::StrFormat("score %.4f, now %.4f", then.score(), now.score()));
  }
  if (GraspsOf(then) != GraspsOf(now)) {
    add(absl::StrCat("grasps ", GraspsOf(then), ", now ", GraspsOf(now)));
  }
  if (out->size() == before) add(FirstDifference(then, now));
}

void CompareResponses(const v1::RecognizeResponse& then, const v1::RecognizeResponse& now,
                      std::vector<std::string>* out) {
  if (then.status() != now.status()) {
    out->push_back(absl::StrCat("the answer was ", v1::RecognitionStatus_Name(then.status()),
                                ", now ", v1::RecognitionStatus_Name(now.status())));
  }
  if (then.detections_size() != now.detections_size()) {
    out->push_back(absl::StrCat(then.detections_size(), " objects, now ", now.detections_size()));
  }
  const int both = std::min(then.detections_size(), now.detections_size());
  for (int i = 0; i < both; ++i) {
    CompareDetections(absl::StrCat("object ", i + 1), then.detections(i), now.detections(i), out);
  }
  if (out->empty()) out->push_back(FirstDifference(then, now));
}

std::string ErrorText(const google::rpc::Status& error) {
  const auto code = static_cast<absl::StatusCode>(error.code());
  return absl::StrCat(absl::StatusCodeToString(code), " ", error.message());
}

}  // namespace

v1::RecognizeRequest ReplayRequest(const v1::Bundle& bundle) {
  v1::RecognizeRequest out = bundle.request();
  out.set_omit_timings(true);
  return out;
}

ReplayResult CompareReplay(const v1::Bundle& bundle,
                           const absl::StatusOr<v1::RecognizeResponse>& now) {
  ReplayResult out;
  out.revision_then =
      bundle.has_response() ? bundle.response().catalog_revision() : bundle.catalog_revision();
  if (now.ok()) out.revision_now = now->catalog_revision();
  if (bundle.has_response() && now.ok()) {
    v1::RecognizeResponse before = Timeless(bundle.response());
    v1::RecognizeResponse after = Timeless(*now);
    if (LacksGrasps(before)) {
      ClearGrasps(&before);
      ClearGrasps(&after);
    }
    out.is_same = AreSame(before, after);
    if (!out.is_same) CompareResponses(before, after, &out.differences);
    return out;
  }
  const std::string then_text = bundle.has_response() ? "an answer" : ErrorText(bundle.error());
  const std::string now_text = now.ok()
                                   ? "an answer"
                                   : absl::StrCat(absl::StatusCodeToString(now.status().code()),
                                                  " ", now.status().message());
  out.is_same = then_text == now_text;
  if (!out.is_same) out.differences.push_back(absl::StrCat(then_text, ", now ", now_text));
  return out;
}

}  // namespace graspdb::client
