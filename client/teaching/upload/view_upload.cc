#include "client/teaching/upload/view_upload.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/messages/scan_message.h"

namespace graspdb::client {
namespace {

// Views in one upload call: after each call the server has stored them.
constexpr int kViewsPerCall = 8;

absl::Status IgnoreExisting(const absl::Status& status) {
  return absl::IsAlreadyExists(status) ? absl::OkStatus() : status;
}

absl::Status CreateStablePose(Client& client, const std::string& object_id,
                              const v1::CapturedStablePose& pose) {
  v1::CreateStablePoseRequest request;
  request.set_parent("objects/" + object_id);
  request.set_stable_pose_id(pose.stable_pose_id());
  v1::StablePose* message = request.mutable_stable_pose();
  if (pose.has_symmetry_order()) message->set_symmetry_order(pose.symmetry_order());
  if (pose.has_min_score()) message->set_min_score(pose.min_score());
  if (pose.has_mesh_pose()) *message->mutable_mesh_pose() = pose.mesh_pose();
  *message->mutable_grasps() = pose.grasps();
  return IgnoreExisting(client.CreateStablePose(request).status());
}

// One upload: the views left to send and the results.
class Upload {
 public:
  Upload(Client& client, const ViewsToTeach& views)
      : client_(client), views_(views), known_(client) {}

  bool IsDone() const { return next_ == views_.count; }
  std::size_t next() const { return next_; }
  const UploadCounts& counts() const { return counts_; }

  absl::Status SendSome() {
    int sent = 0;
    absl::StatusOr<v1::UploadViewsResponse> response =
        client_.UploadViews([&](v1::UploadViewsRequest* request) -> absl::StatusOr<bool> {
          while (!IsDone() && sent < kViewsPerCall) {
            ASSIGN_OR_RETURN(bool wanted, Prepare(next_++, request));
            if (!wanted) continue;
            ++sent;
            return true;
          }
          return false;
        });
    if (!response.ok()) return response.status();
    counts_.created += response->created_count();
    counts_.existing += response->existing_count();
    return absl::OkStatus();
  }

 private:
  // Fills the request; false when the server has the view already.
  absl::StatusOr<bool> Prepare(std::size_t i, v1::UploadViewsRequest* request) {
    request->Clear();
    RETURN_IF_ERROR(MakeRequest(views_, i, request));
    ASSIGN_OR_RETURN(const bool known, known_.Has(request->parent(), request->view_id()));
    if (!known) return true;
    if (!views_.replace) {
      ++counts_.existing;
      return false;
    }
    RETURN_IF_ERROR(client_.DeleteView(ViewNameOf(*request)));
    return true;
  }

  Client& client_;
  const ViewsToTeach& views_;
  KnownViews known_;
  std::size_t next_ = 0;
  UploadCounts counts_;
};

}  // namespace

absl::Status MakeRequest(const ViewsToTeach& views, std::size_t i,
                         v1::UploadViewsRequest* request) {
  RETURN_IF_ERROR(views.make(i, request));
  if (request->view_id().empty()) request->set_view_id(files::ContentId(request->view()));
  return absl::OkStatus();
}

std::string ViewNameOf(const v1::UploadViewsRequest& request) {
  return absl::StrCat(request.parent(), "/views/", request.view_id());
}

std::string StablePoseName(const std::string& object_id, const std::string& stable_pose_id) {
  return absl::StrCat("objects/", object_id, "/stablePoses/", stable_pose_id);
}

absl::Status CreateParents(Client& client, const std::vector<v1::CapturedObject>& objects) {
  for (const v1::CapturedObject& object : objects) {
    v1::CreateObjectRequest request;
    request.set_object_id(object.object_id());
    request.mutable_object()->set_display_name(object.display_name());
    RETURN_IF_ERROR(IgnoreExisting(client.CreateObject(request).status()));
    for (const v1::CapturedStablePose& pose : object.stable_poses()) {
      RETURN_IF_ERROR(CreateStablePose(client, object.object_id(), pose));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<UploadCounts> TeachViews(Client& client, const ViewsToTeach& views,
                                        const UploadWatch& watch) {
  Upload upload(client, views);
  while (!upload.IsDone()) {
    if (watch.cancelled && watch.cancelled()) {
      return absl::CancelledError(
          absl::StrCat("interrupted after ", upload.next(), " of ", views.count,
                       " views, which are safe; run the same command again to go on"));
    }
    RETURN_IF_ERROR(upload.SendSome());
    if (watch.report) watch.report(upload.next());
  }
  return upload.counts();
}

absl::Status CheckStep(double step_deg) {
  if (step_deg >= 1 && step_deg <= 120) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "the step of the turntable is not between 1 and 120 degrees; the usual one is 20");
}

int StepsOf(double step_deg) {
  if (!CheckStep(step_deg).ok()) return 0;
  return static_cast<int>(std::ceil(360 / step_deg - 1e-9));  // 360 itself is 0 again
}

}  // namespace graspdb::client
