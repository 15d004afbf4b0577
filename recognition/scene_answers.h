// What a frame shows beyond its segments: judges every answer in the image, and finds objects
// where no segment is one object. docs/adr/0033-the-image-judges-every-answer.md.
#pragma once

#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "recognition/answered_segment.h"
#include "recognition/base/stages.h"
#include "recognition/frame/frame.h"
#include "recognition/recognizer.h"

namespace graspdb::recognition {

// The scan as an image.
struct SceneFrame {
  // With points of interest, a part of it around them.
  void Make(const Scan& scan, const Segmentation& segmentation, const FrameParameters& parameters,
            const Points& of_interest, const IsCancelled& is_cancelled);

  std::optional<Frame> frame;
  StageLog log;  // step "frame"
};

// Judges each answer of `answers` that has a view, rejects those that the image contradicts, and
// adds detections of objects that point pairs find in the rest of the frame. Steps "frame",
// "verify", "propose" and "explain". Makes the part of the frame that it needs where `frame` has
// none; the search needs all of it. Not for segmented scans. Deterministic. Errors as LoadModel;
// CANCELLED.
absl::Status ExplainScene(const Scan& scan, const Segmentation& segmentation,
                          const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                          const RecognitionParameters& parameters, const IsCancelled& is_cancelled,
                          SceneFrame frame, StageLog* log, std::vector<AnsweredSegment>* answers);

}  // namespace graspdb::recognition
