#include "server/requests/scan_from_proto.h"

#include "files/messages/read_scan.h"
#include "server/base/errors.h"

namespace graspdb::server {

absl::Status ReadScan(const v1::RecognizeRequest& request, std::size_t max_points,
                      recognition::Scan* scan) {
  const files::ScanRules rules{.wrong = &InvalidField, .max_points = max_points};
  switch (request.scan_case()) {
    case v1::RecognizeRequest::kCloud:
      return files::ReadScan(request.cloud(), rules, "cloud", scan);
    case v1::RecognizeRequest::kDepthImage:
      return files::ReadScan(request.depth_image(), rules, "depth_image", scan);
    case v1::RecognizeRequest::SCAN_NOT_SET:
      break;
  }
  return InvalidField("scan", "is missing: give a cloud or a depth_image");
}

absl::Status ReadScan(const v1::View& view, std::size_t max_points, recognition::Scan* scan) {
  if (view.has_cloud() && view.has_depth_image()) {
    return InvalidField("view", "has both a cloud and a depth_image; give one of them");
  }
  const files::ScanRules rules{.wrong = &InvalidField, .max_points = max_points};
  if (view.has_cloud()) return files::ReadScan(view.cloud(), rules, "view.cloud", scan);
  if (view.has_depth_image()) {
    return files::ReadScan(view.depth_image(), rules, "view.depth_image", scan);
  }
  return InvalidField("view", "has neither a cloud nor a depth_image; give one of them");
}

}  // namespace graspdb::server
