// ObjectHistoryService over the storage.
#pragma once

#include "absl/time/time.h"
#include "graspdb/v1/object_history_service.grpc.pb.h"
#include "recognition/descriptors/descriptor.h"
#include "storage/catalogue/catalogue.h"
#include "storage/history/history.h"

namespace graspdb::server {

// Thread-safe.
class ObjectHistoryService final : public v1::ObjectHistoryService::Service {
 public:
  // `catalogue` must outlive this. Restored views are described with `parameters`. Deleted objects
  // are kept for `kept`.
  ObjectHistoryService(storage::Catalogue& catalogue,
                       const recognition::DescriptorParameters& parameters, absl::Duration kept)
      : catalogue_(catalogue), parameters_(parameters), kept_(kept) {}

  grpc::Status ListDeletedObjects(grpc::ServerContext* context,
                                  const v1::ListDeletedObjectsRequest* request,
                                  v1::ListDeletedObjectsResponse* response) override;
  grpc::Status GetDeletedObject(grpc::ServerContext* context,
                                const v1::GetDeletedObjectRequest* request,
                                v1::Object* response) override;
  grpc::Status UndeleteObject(grpc::ServerContext* context,
                              const v1::UndeleteObjectRequest* request,
                              v1::Object* response) override;
  grpc::Status PurgeObject(grpc::ServerContext* context, const v1::PurgeObjectRequest* request,
                           google::protobuf::Empty* response) override;
  grpc::Status ListObjectRevisions(grpc::ServerContext* context,
                                   const v1::ListObjectRevisionsRequest* request,
                                   v1::ListObjectRevisionsResponse* response) override;
  grpc::Status RestoreObject(grpc::ServerContext* context, const v1::RestoreObjectRequest* request,
                             v1::Object* response) override;

 private:
  v1::Object ToProto(const storage::DeletedObjectRecord& record) const;
  // Logs the views that cannot be used.
  void Describe(const std::string& object) const;

  storage::Catalogue& catalogue_;
  const recognition::DescriptorParameters parameters_;
  const absl::Duration kept_;
};

}  // namespace graspdb::server
