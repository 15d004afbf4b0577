// Converts a recognition to the response of the public contract.
#pragma once

#include <string>

#include "graspdb/v1/recognition_service.pb.h"
#include "recognition/recognizer.h"

namespace graspdb::server {

// What the recognition does not know of the request and its catalogue.
struct AnswerContext {
  std::string catalog_id;
  bool sensor_pose_from_cell = false;
  double decode_ms = 0;
  double total_ms = 0;
};

// `snapshot` is the one that the recognition used.
v1::RecognizeResponse MakeAnswer(const recognition::Recognition& recognition,
                                 const recognition::CatalogueSnapshot& snapshot,
                                 const AnswerContext& context);

// For RecognizeRequest.omit_timings, which leaves out the catalogue's id too.
void LeaveOutTimings(v1::RecognizeResponse* response);

}  // namespace graspdb::server
