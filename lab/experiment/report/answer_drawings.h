// Drawings of answers for the report, after figures 10 and 16 of the paper.
#pragma once

#include "files/base/json_object.h"
#include "lab/experiment/experiment.h"

namespace graspdb::lab {

// Answers that are drawn for a case.
inline constexpr std::size_t kDrawnAnswers = 8;

// "drawings": a list of the worst answers, the worst first, in the image of the camera: a "title",
// and pixels
// ("u", "v") of the "scan" (where `result.scans` has it), of the model at its true pose ("truth")
// and at the estimated one ("match"). Points on the far side are left out.
void FillDrawings(const CaseResult& result, files::JsonObject* out);

// The ten nearest views of the worst answer that has candidates: "scene", "stable_pose_query",
// "answered" and the "views" with "object", "descriptor_distance", "verification_score" (null: not
// verified) and "chosen". Null where no answer has candidates.
void FillFirstMatches(const CaseResult& result, google::protobuf::Value* value);

}  // namespace graspdb::lab
