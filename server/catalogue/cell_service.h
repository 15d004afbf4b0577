// CellService over the storage.
#pragma once

#include "graspdb/v1/cell_service.grpc.pb.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// Thread-safe. `catalogue` must outlive it.
class CellService final : public v1::CellService::Service {
 public:
  explicit CellService(storage::Catalogue& catalogue) : catalogue_(catalogue) {}

  grpc::Status CreateCell(grpc::ServerContext* context, const v1::CreateCellRequest* request,
                          v1::Cell* response) override;
  grpc::Status GetCell(grpc::ServerContext* context, const v1::GetCellRequest* request,
                       v1::Cell* response) override;
  grpc::Status ListCells(grpc::ServerContext* context, const v1::ListCellsRequest* request,
                         v1::ListCellsResponse* response) override;
  grpc::Status UpdateCell(grpc::ServerContext* context, const v1::UpdateCellRequest* request,
                          v1::Cell* response) override;
  grpc::Status DeleteCell(grpc::ServerContext* context, const v1::DeleteCellRequest* request,
                          google::protobuf::Empty* response) override;

 private:
  storage::Catalogue& catalogue_;
};

}  // namespace graspdb::server
