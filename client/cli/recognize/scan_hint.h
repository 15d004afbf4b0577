// What to try where an answer has no object.
#pragma once

#include <string>

#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::client {

// Where the points of the scan are, if that may be why nothing was found in it; else empty.
std::string ScanHint(const v1::RecognizeRequest& request, const v1::RecognizeResponse& response);

}  // namespace graspdb::client
