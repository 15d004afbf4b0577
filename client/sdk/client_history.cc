// Deleted objects and earlier revisions of objects.
#include "client/sdk/client_call.h"

namespace graspdb::client {
namespace {

using History = v1::ObjectHistoryService::Stub;

}  // namespace

absl::StatusOr<std::vector<v1::Object>> Client::ListDeletedObjects() {
  return ListAll(*stubs_->history, &History::ListDeletedObjects, v1::ListDeletedObjectsRequest(),
                 &v1::ListDeletedObjectsResponse::mutable_objects);
}

absl::StatusOr<v1::Object> Client::GetDeletedObject(const std::string& name) {
  return Call(*stubs_->history, &History::GetDeletedObject,
              Named<v1::GetDeletedObjectRequest>(name));
}

absl::StatusOr<v1::Object> Client::UndeleteObject(const std::string& name) {
  return Call(*stubs_->history, &History::UndeleteObject, Named<v1::UndeleteObjectRequest>(name));
}

absl::Status Client::PurgeObject(const std::string& name) {
  return Call(*stubs_->history, &History::PurgeObject, Named<v1::PurgeObjectRequest>(name))
      .status();
}

absl::StatusOr<std::vector<v1::ObjectRevision>> Client::ListObjectRevisions(
    const std::string& object) {
  v1::ListObjectRevisionsRequest request;
  request.set_parent(object);
  return ListAll(*stubs_->history, &History::ListObjectRevisions, request,
                 &v1::ListObjectRevisionsResponse::mutable_revisions);
}

absl::StatusOr<v1::Object> Client::RestoreObject(const v1::RestoreObjectRequest& request) {
  return Call(*stubs_->history, &History::RestoreObject, request);
}

}  // namespace graspdb::client
