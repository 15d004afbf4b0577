#include "server/catalogue/catalog_service.h"

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "base/status_macros.h"
#include "files/messages/scan_message.h"
#include "server/base/errors.h"
#include "server/calls/handle.h"
#include "server/catalogue/grasp_outcomes.h"
#include "server/live/records.h"
#include "server/requests/convert.h"
#include "server/requests/record_checks.h"
#include "server/requests/respond.h"
#include "storage/records/resource_name.h"

namespace graspdb::server {
namespace {

constexpr std::array<std::string_view, 3> kObjectFields = {"display_name", "labels", "release"};
constexpr std::array<std::string_view, 6> kStablePoseFields = {
    "display_name", "symmetry_order", "grasps", "min_score", "mesh_pose", "release"};

absl::Status CheckObject(const v1::Object& object) {
  RETURN_IF_ERROR(CheckLabels(object.labels(), "object.labels"));
  return CheckRelease(object.release(), "object.release");
}

absl::Status CheckStablePose(const v1::StablePose& pose) {
  RETURN_IF_ERROR(StablePoseFromProto(pose).status());
  return CheckRelease(pose.release(), "stable_pose.release");
}

v1::View ViewToProto(const storage::ViewRecord& record) {
  v1::View out;
  out.set_name(record.name());
  *out.mutable_object_pose() = record.object_pose();
  *out.mutable_sensor_pose() = record.sensor_pose();
  out.set_segmented(true);
  out.set_object_pose_estimated(!record.object_pose_given());
  out.set_point_count(record.point_count());
  *out.mutable_create_time() = record.create_time();
  return out;
}

// Describes a view's cloud by each kind of descriptor that can.
absl::Status AddDescriptors(const storage::ViewRecord& record, std::string_view packed,
                            recognition::DescriptorParameters parameters, v1::View* view) {
  ASSIGN_OR_RETURN(const auto taught, ViewFromRecord(record));
  const recognition::Pose& sensor = taught->world_sensor;
  ASSIGN_OR_RETURN(const recognition::OrientedCloud cloud,
                   CloudFromPacked(packed, sensor, parameters));
  for (const std::string& name : recognition::DescriptorNames()) {
    parameters.kind = *recognition::DescriptorFromName(name);
    const auto descriptor = MakeDescriptorRecord(cloud, sensor, parameters);
    if (absl::IsFailedPrecondition(descriptor.status())) continue;
    RETURN_IF_ERROR(descriptor.status());
    v1::ViewDescriptor& added = *view->add_descriptors();
    added.set_name(name);
    *added.mutable_bins() = descriptor->bins();
  }
  return absl::OkStatus();
}

}  // namespace

CatalogService::CatalogService(CatalogContext context)
    : context_(std::move(context)), start_(std::chrono::steady_clock::now()) {}

grpc::Status CatalogService::CreateObject(grpc::ServerContext* context,
                                          const v1::CreateObjectRequest* request,
                                          v1::Object* response) {
  return Handle(*context, "CreateObject", *request, [&]() -> absl::Status {
    RETURN_IF_ERROR(AtField("object_id", storage::ValidateResourceId(request->object_id())));
    RETURN_IF_ERROR(CheckObject(request->object()));
    v1::Object object = request->object();
    object.DiscardUnknownFields();
    object.set_name(storage::MakeObjectName(request->object_id()));
    return Respond("object_id", context_.catalogue.CreateObject(std::move(object)), response);
  });
}

grpc::Status CatalogService::GetObject(grpc::ServerContext* context,
                                       const v1::GetObjectRequest* request, v1::Object* response) {
  return Handle(*context, "GetObject", *request, [&] {
    return Respond("name", context_.catalogue.GetObject(request->name()), response);
  });
}

grpc::Status CatalogService::ListObjects(grpc::ServerContext* context,
                                         const v1::ListObjectsRequest* request,
                                         v1::ListObjectsResponse* response) {
  return Handle(*context, "ListObjects", *request, [&] {
    return RespondPage(
        *request, "objects/",
        [&](std::size_t size, const std::string& after) {
          return context_.catalogue.ListObjects(size, after);
        },
        [&](v1::Object object) { *response->add_objects() = std::move(object); }, response);
  });
}

grpc::Status CatalogService::UpdateObject(grpc::ServerContext* context,
                                          const v1::UpdateObjectRequest* request,
                                          v1::Object* response) {
  return Handle(*context, "UpdateObject", *request, [&] {
    const v1::Object& update = request->object();
    const auto change = [&](v1::Object& object) {
      RETURN_IF_ERROR(ApplyReleasedUpdate(update, request->update_mask(), kObjectFields, &object));
      return CheckObject(object);
    };
    return Respond("object.name",
                   context_.catalogue.UpdateObject(update.name(), update.etag(), change), response);
  });
}

grpc::Status CatalogService::DeleteObject(grpc::ServerContext* context,
                                          const v1::DeleteObjectRequest* request,
                                          google::protobuf::Empty* /*response*/) {
  return Handle(*context, "DeleteObject", *request, [&] {
    return AtField("name", context_.catalogue.DeleteObject(request->name(), request->force(),
                                                           request->etag()));
  });
}

grpc::Status CatalogService::CreateStablePose(grpc::ServerContext* context,
                                              const v1::CreateStablePoseRequest* request,
                                              v1::StablePose* response) {
  return Handle(*context, "CreateStablePose", *request, [&]() -> absl::Status {
    absl::StatusOr<storage::ObjectName> parent = storage::ParseObjectName(request->parent());
    if (!parent.ok()) return AtField("parent", parent.status());
    RETURN_IF_ERROR(
        AtField("stable_pose_id", storage::ValidateResourceId(request->stable_pose_id())));
    v1::StablePose pose = request->stable_pose();
    pose.DiscardUnknownFields();
    pose.set_name(storage::MakeStablePoseName(parent->object_id, request->stable_pose_id()));
    RETURN_IF_ERROR(CheckStablePose(pose));
    return Respond("parent", context_.catalogue.CreateStablePose(std::move(pose)), response);
  });
}

grpc::Status CatalogService::GetStablePose(grpc::ServerContext* context,
                                           const v1::GetStablePoseRequest* request,
                                           v1::StablePose* response) {
  return Handle(*context, "GetStablePose", *request, [&] {
    RETURN_IF_ERROR(Respond("name", context_.catalogue.GetStablePose(request->name()), response));
    return AddGraspOutcomes(context_.catalogue, response);
  });
}

grpc::Status CatalogService::ListStablePoses(grpc::ServerContext* context,
                                             const v1::ListStablePosesRequest* request,
                                             v1::ListStablePosesResponse* response) {
  return Handle(*context, "ListStablePoses", *request, [&]() -> absl::Status {
    absl::Status status = RespondPage(
        *request, request->parent() + "/stablePoses/",
        [&](std::size_t size, const std::string& after) {
          return context_.catalogue.ListStablePoses(request->parent(), size, after);
        },
        [&](v1::StablePose pose) { *response->add_stable_poses() = std::move(pose); }, response);
    if (!status.ok()) return status;
    for (v1::StablePose& pose : *response->mutable_stable_poses()) {
      RETURN_IF_ERROR(AddGraspOutcomes(context_.catalogue, &pose));
    }
    return absl::OkStatus();
  });
}

grpc::Status CatalogService::UpdateStablePose(grpc::ServerContext* context,
                                              const v1::UpdateStablePoseRequest* request,
                                              v1::StablePose* response) {
  return Handle(*context, "UpdateStablePose", *request, [&] {
    const v1::StablePose& update = request->stable_pose();
    const auto change = [&](v1::StablePose& pose) {
      RETURN_IF_ERROR(
          ApplyReleasedUpdate(update, request->update_mask(), kStablePoseFields, &pose));
      return CheckStablePose(pose);
    };
    return Respond("stable_pose.name",
                   context_.catalogue.UpdateStablePose(update.name(), update.etag(), change),
                   response);
  });
}

grpc::Status CatalogService::DeleteStablePose(grpc::ServerContext* context,
                                              const v1::DeleteStablePoseRequest* request,
                                              google::protobuf::Empty* /*response*/) {
  return Handle(*context, "DeleteStablePose", *request, [&] {
    return AtField("name", context_.catalogue.DeleteStablePose(request->name(), request->force(),
                                                               request->etag()));
  });
}

grpc::Status CatalogService::GetView(grpc::ServerContext* context,
                                     const v1::GetViewRequest* request, v1::View* response) {
  return Handle(*context, "GetView", *request, [&]() -> absl::Status {
    absl::StatusOr<storage::ViewRecord> record = context_.catalogue.GetView(request->name());
    if (!record.ok()) return AtField("name", record.status());
    *response = ViewToProto(*record);
    if (request->detail() == v1::VIEW_DETAIL_FULL) {
      ASSIGN_OR_RETURN(std::string packed, context_.catalogue.GetPackedCloud(request->name()));
      ASSIGN_OR_RETURN(recognition::Points points, PointsFromPacked(packed));
      *response->mutable_cloud() = files::CloudMessage(points, 0);
    } else if (request->detail() == v1::VIEW_DETAIL_DESCRIBED) {
      const auto is_cancelled = [&] { return IsAbandoned(*context); };
      ASSIGN_OR_RETURN(const Admission::Ticket ticket, describing_.Enter(is_cancelled));
      ASSIGN_OR_RETURN(std::string packed, context_.catalogue.GetPackedCloud(request->name()));
      return AddDescriptors(*record, packed, context_.parameters.descriptor, response);
    }
    return absl::OkStatus();
  });
}

grpc::Status CatalogService::ListViews(grpc::ServerContext* context,
                                       const v1::ListViewsRequest* request,
                                       v1::ListViewsResponse* response) {
  return Handle(*context, "ListViews", *request, [&] {
    return RespondPage(
        *request, request->parent() + "/views/",
        [&](std::size_t size, const std::string& after) {
          return context_.catalogue.ListViews(request->parent(), size, after);
        },
        [&](const storage::ViewRecord& view) { *response->add_views() = ViewToProto(view); },
        response);
  });
}

grpc::Status CatalogService::DeleteView(grpc::ServerContext* context,
                                        const v1::DeleteViewRequest* request,
                                        google::protobuf::Empty* /*response*/) {
  return Handle(*context, "DeleteView", *request,
                [&] { return AtField("name", context_.catalogue.DeleteView(request->name())); });
}

grpc::Status CatalogService::ReportGraspOutcome(grpc::ServerContext* context,
                                                const v1::ReportGraspOutcomeRequest* request,
                                                v1::ReportGraspOutcomeResponse* response) {
  return Handle(*context, "ReportGraspOutcome", *request, [&]() -> absl::Status {
    if (request->has_cell()) {
      const auto cell = context_.catalogue.GetCell(request->cell());
      if (!cell.ok()) return AtField("cell", cell.status());
    }
    ASSIGN_OR_RETURN(const bool counted,
                     server::ReportGraspOutcome(*request, context_.catalogue, response));
    const CallGuard& guard = *CallGuard::Of(*context);
    if (counted && guard.metrics() != nullptr) {
      guard.metrics()->CountPicks(request->has_cell() ? request->cell() : guard.cell(), *request);
    }
    return absl::OkStatus();
  });
}

}  // namespace graspdb::server
