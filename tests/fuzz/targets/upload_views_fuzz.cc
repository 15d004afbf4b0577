// Uploads: rejected views, and the effect of taught views on later frames.
#include <cstdint>

#include "tests/fuzz/calls.h"
#include "tests/fuzz/fuzz_server.h"
#include "tests/fuzz/message_target.h"
#include "tests/fuzz/operations.pb.h"
#include "tests/fuzz/requirement.h"
#include "tests/fuzz/sample_frames.h"

namespace graspdb::fuzz {
namespace {

constexpr char kObject[] = "objects/fuzzed";
constexpr char kStablePose[] = "objects/fuzzed/stablePoses/flat";
constexpr int kMaxViews = 8;
// A new database after this many inputs, since it keeps every change in memory.
constexpr int kInputsOfDatabase = 500;

const std::vector<std::string>& Words() {
  static const std::vector<std::string> words = {
      kStablePose, "objects/fuzzed", "a", "x", "y", "z", "objects/none/stablePoses/flat"};
  return words;
}

// The frame that must be answered with any taught views.
const v1::RecognizeRequest& UsualFrame() {
  static const v1::RecognizeRequest frame = [] {
    v1::RecognizeRequest request;
    const v1::UploadViewsRequest seen = SegmentedView(kFusedPart, 30, "seen", false);
    *request.mutable_cloud() = seen.view().cloud();
    *request.mutable_sensor_pose() = seen.view().sensor_pose();
    request.set_segmented(true);
    return request;
  }();
  return frame;
}

void ListViews(FuzzServer& server, int expected) {
  v1::ListViewsRequest request;
  request.set_parent(kStablePose);
  request.set_page_size(1000);
  grpc::ClientContext context;
  v1::ListViewsResponse response;
  Require(server.catalog().ListViews(&context, request, &response).ok(), "views are listed");
  Require(response.views_size() == expected, "as many views as were acknowledged");
  for (const v1::View& view : response.views()) {
    v1::GetViewRequest get;
    get.set_name(view.name());
    const auto read = [&](v1::ViewDetail detail) {
      get.set_detail(detail);
      grpc::ClientContext get_context;
      v1::View got;
      Require(server.catalog().GetView(&get_context, get, &got).ok(), "a view is read");
      return got;
    };
    Require(!read(v1::VIEW_DETAIL_FULL).cloud().data().empty(), "with its cloud");
    Require(read(v1::VIEW_DETAIL_DESCRIBED).descriptors_size() > 0, "with its descriptors");
  }
}

void Run(fuzz::Uploads uploads) {
  static FuzzServer server;
  static int inputs = 0;
  if (uploads.views_size() > kMaxViews) return;
  if (inputs++ % kInputsOfDatabase == 0) server.StartAnew();
  server.Declare("fuzzed");
  v1::UploadViewsResponse response;
  const grpc::Status uploaded = server.Upload(uploads.views(), &response);
  RequireAnswer(uploaded);
  if (uploaded.ok()) ListViews(server, response.created_count());
  grpc::ClientContext context;
  v1::RecognizeResponse answer;
  const grpc::Status status = server.recognition().Recognize(&context, UsualFrame(), &answer);
  Require(status.ok(), "frames are answered with any taught views");
  v1::DeleteObjectRequest remove;
  remove.set_name(kObject);
  remove.set_force(true);
  grpc::ClientContext remove_context;
  google::protobuf::Empty nothing;
  Require(server.catalog().DeleteObject(&remove_context, remove, &nothing).ok(),
          "a taught object can be deleted");
}

}  // namespace
}  // namespace graspdb::fuzz

GRASPDB_FUZZ_MESSAGES(graspdb::fuzz::Uploads, graspdb::fuzz::Words(), graspdb::fuzz::Run)
