#include "server/catalogue/cell_service.h"

#include <array>
#include <utility>

#include "base/status_macros.h"
#include "server/base/errors.h"
#include "server/calls/handle.h"
#include "server/requests/convert.h"
#include "server/requests/record_checks.h"
#include "server/requests/respond.h"
#include "storage/records/resource_name.h"

namespace graspdb::server {
namespace {

constexpr std::array<std::string_view, 9> kFields = {
    "display_name",       "sensor_pose", "region_of_interest",
    "workspace",          "pipeline",    "robot_base_pose",
    "flange_sensor_pose", "labels",      "include_drafts"};

// INVALID_ARGUMENT when the cell's poses, boxes or settings are wrong.
absl::Status ValidateCell(const v1::Cell& cell) {
  absl::Status status;
  if (cell.has_sensor_pose()) {
    status.Update(PoseFromProto(cell.sensor_pose(), "cell.sensor_pose").status());
  }
  if (cell.has_robot_base_pose()) {
    status.Update(PoseFromProto(cell.robot_base_pose(), "cell.robot_base_pose").status());
  }
  if (cell.has_flange_sensor_pose()) {
    status.Update(PoseFromProto(cell.flange_sensor_pose(), "cell.flange_sensor_pose").status());
  }
  if (cell.has_region_of_interest()) {
    status.Update(BoxFromProto(cell.region_of_interest(), "cell.region_of_interest").status());
  }
  if (cell.has_workspace()) {
    status.Update(BoxFromProto(cell.workspace(), "cell.workspace").status());
  }
  status.Update(CheckLabels(cell.labels(), "cell.labels"));
  recognition::RecognitionParameters scratch;
  status.Update(ApplyPipeline(cell.pipeline(), "cell.pipeline", &scratch));
  return status;
}

}  // namespace

grpc::Status CellService::CreateCell(grpc::ServerContext* context,
                                     const v1::CreateCellRequest* request, v1::Cell* response) {
  return Handle(*context, "CreateCell", *request, [&]() -> absl::Status {
    if (absl::Status status = storage::ValidateResourceId(request->cell_id()); !status.ok()) {
      return InvalidField("cell_id", std::string(status.message()));
    }
    v1::Cell cell = request->cell();
    cell.DiscardUnknownFields();
    cell.set_name(storage::MakeCellName(request->cell_id()));
    RETURN_IF_ERROR(ValidateCell(cell));
    return Respond("cell_id", catalogue_.CreateCell(std::move(cell)), response);
  });
}

grpc::Status CellService::GetCell(grpc::ServerContext* context, const v1::GetCellRequest* request,
                                  v1::Cell* response) {
  return Handle(*context, "GetCell", *request,
                [&] { return Respond("name", catalogue_.GetCell(request->name()), response); });
}

grpc::Status CellService::ListCells(grpc::ServerContext* context,
                                    const v1::ListCellsRequest* request,
                                    v1::ListCellsResponse* response) {
  return Handle(*context, "ListCells", *request, [&] {
    return RespondPage(
        *request, "cells/",
        [&](std::size_t size, const std::string& after) {
          return catalogue_.ListCells(size, after);
        },
        [&](v1::Cell cell) { *response->add_cells() = std::move(cell); }, response);
  });
}

grpc::Status CellService::UpdateCell(grpc::ServerContext* context,
                                     const v1::UpdateCellRequest* request, v1::Cell* response) {
  return Handle(*context, "UpdateCell", *request, [&] {
    const v1::Cell& update = request->cell();
    const auto change = [&](v1::Cell& cell) {
      RETURN_IF_ERROR(ApplyUpdate(update, request->update_mask(), kFields, &cell));
      return ValidateCell(cell);
    };
    return Respond("cell.name", catalogue_.UpdateCell(update.name(), update.etag(), change),
                   response);
  });
}

grpc::Status CellService::DeleteCell(grpc::ServerContext* context,
                                     const v1::DeleteCellRequest* request,
                                     google::protobuf::Empty* /*response*/) {
  return Handle(*context, "DeleteCell", *request, [&] {
    return AtField("name", catalogue_.DeleteCell(request->name(), request->etag()));
  });
}

}  // namespace graspdb::server
