#include "server/history/object_history_service.h"

#include <google/protobuf/util/time_util.h>
#include <spdlog/spdlog.h>

#include <string>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/log/log_field.h"
#include "server/base/background.h"
#include "server/base/errors.h"
#include "server/calls/handle.h"
#include "server/live/load_views.h"
#include "server/requests/respond.h"
#include "storage/database/family.h"

namespace graspdb::server {
namespace {

using google::protobuf::util::TimeUtil;

// As in the contract; with the longest names 11 KB a change.
constexpr int kMaxEdits = 50;

v1::EditKind KindOf(const storage::PreviousRecord& previous) {
  if (previous.removed()) return v1::EDIT_KIND_DELETED;
  return previous.has_value() ? v1::EDIT_KIND_UPDATED : v1::EDIT_KIND_CREATED;
}

v1::ObjectRevision RevisionToProto(const std::string& prefix, const storage::HistoryRecord& row) {
  v1::ObjectRevision out;
  out.set_name(absl::StrCat(prefix, row.revision()));
  out.set_revision(row.revision());
  *out.mutable_change_time() = row.time();
  out.set_identity(row.identity());
  out.set_method(row.method());
  out.set_edit_count(row.edit_count());
  for (const storage::PreviousRecord& previous : row.previous()) {
    if (previous.column_family() == storage::FamilyName(storage::Family::kGraspOutcomes)) continue;
    if (out.edits_size() == kMaxEdits) break;
    v1::ResourceEdit& edit = *out.add_edits();
    edit.set_name(previous.key());
    edit.set_kind(KindOf(previous));
    *edit.mutable_fields() = previous.fields();
  }
  return out;
}

// The revision at the end of a page; 0 for the first page.
absl::StatusOr<std::int64_t> RevisionAfter(const std::string& name, const std::string& prefix) {
  std::int64_t revision = 0;
  if (name.empty()) return revision;
  if (absl::SimpleAtoi(name.substr(prefix.size()), &revision) && revision > 0) return revision;
  return InvalidField("page_token", "is not a page token of this list");
}

}  // namespace

v1::Object ObjectHistoryService::ToProto(const storage::DeletedObjectRecord& record) const {
  v1::Object out = record.object();
  *out.mutable_purge_time() = TimeUtil::NanosecondsToTimestamp(
      TimeUtil::TimestampToNanoseconds(out.delete_time()) + absl::ToInt64Nanoseconds(kept_));
  return out;
}

grpc::Status ObjectHistoryService::ListDeletedObjects(grpc::ServerContext* context,
                                                      const v1::ListDeletedObjectsRequest* request,
                                                      v1::ListDeletedObjectsResponse* response) {
  return Handle(*context, "ListDeletedObjects", *request, [&] {
    return RespondPage(
        *request, "objects/",
        [&](std::size_t size, const std::string& after) {
          return catalogue_.history().ListDeleted(size, after);
        },
        [&](const storage::DeletedObjectRecord& record) {
          *response->add_objects() = Answerable(ToProto(record));
        },
        response);
  });
}

grpc::Status ObjectHistoryService::GetDeletedObject(grpc::ServerContext* context,
                                                    const v1::GetDeletedObjectRequest* request,
                                                    v1::Object* response) {
  return Handle(*context, "GetDeletedObject", *request, [&]() -> absl::Status {
    const auto record = catalogue_.history().GetDeleted(request->name());
    if (!record.ok()) return AtField("name", record.status());
    *response = Answerable(ToProto(*record));
    return absl::OkStatus();
  });
}

void ObjectHistoryService::Describe(const std::string& object) const {
  // Milliseconds for each view, where the parameters changed since.
  const absl::Status described =
      InBackground([&] { return DescribeObject(catalogue_, object, parameters_); });
  if (described.ok()) return;
  spdlog::error("event=restored_views_not_described object={} error={}", LogField(object),
                LogField(std::string(described.message())));
}

grpc::Status ObjectHistoryService::UndeleteObject(grpc::ServerContext* context,
                                                  const v1::UndeleteObjectRequest* request,
                                                  v1::Object* response) {
  return Handle(*context, "UndeleteObject", *request, [&] {
    absl::Status status = Respond("name", catalogue_.history().Undelete(request->name()), response);
    if (status.ok()) Describe(request->name());
    return status;
  });
}

grpc::Status ObjectHistoryService::PurgeObject(grpc::ServerContext* context,
                                               const v1::PurgeObjectRequest* request,
                                               google::protobuf::Empty* /*response*/) {
  return Handle(*context, "PurgeObject", *request,
                [&] { return AtField("name", catalogue_.history().Purge(request->name())); });
}

grpc::Status ObjectHistoryService::ListObjectRevisions(
    grpc::ServerContext* context, const v1::ListObjectRevisionsRequest* request,
    v1::ListObjectRevisionsResponse* response) {
  return Handle(*context, "ListObjectRevisions", *request, [&] {
    const std::string prefix = request->parent() + "/revisions/";
    const auto list =
        [&](std::size_t size,
            const std::string& after) -> absl::StatusOr<storage::Page<v1::ObjectRevision>> {
      ASSIGN_OR_RETURN(const auto before, RevisionAfter(after, prefix));
      ASSIGN_OR_RETURN(const auto rows, catalogue_.history().List(request->parent(), size, before));
      storage::Page<v1::ObjectRevision> page = {{}, rows.more};
      page.records.reserve(rows.records.size());
      for (const auto& row : rows.records) page.records.push_back(RevisionToProto(prefix, row));
      return page;
    };
    return RespondPage(
        *request, prefix, list,
        [&](v1::ObjectRevision revision) { *response->add_revisions() = std::move(revision); },
        response);
  });
}

grpc::Status ObjectHistoryService::RestoreObject(grpc::ServerContext* context,
                                                 const v1::RestoreObjectRequest* request,
                                                 v1::Object* response) {
  return Handle(*context, "RestoreObject", *request, [&]() -> absl::Status {
    if (request->revision() < 1) return InvalidField("revision", "must be at least 1");
    absl::Status status = Respond(
        "name", catalogue_.history().Restore(request->name(), request->revision(), request->etag()),
        response);
    if (status.ok()) Describe(request->name());
    return status;
  });
}

}  // namespace graspdb::server
