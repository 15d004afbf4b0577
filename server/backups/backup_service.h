// BackupService over the storage.
#pragma once

#include "graspdb/v1/backup_service.grpc.pb.h"
#include "server/backups/catalogue_backups.h"

namespace graspdb::server {

// Thread-safe.
class BackupService final : public v1::BackupService::Service {
 public:
  // Null: the server has no folder for backups. Must outlive the service.
  explicit BackupService(CatalogueBackups* backups) : backups_(backups) {}

  grpc::Status CreateBackup(grpc::ServerContext* context, const v1::CreateBackupRequest* request,
                            grpc::ServerWriter<v1::CreateBackupResponse>* stream) override;
  grpc::Status ListBackups(grpc::ServerContext* context, const v1::ListBackupsRequest* request,
                           v1::ListBackupsResponse* response) override;
  grpc::Status VerifyBackup(grpc::ServerContext* context, const v1::VerifyBackupRequest* request,
                            grpc::ServerWriter<v1::VerifyBackupResponse>* stream) override;
  grpc::Status DeleteBackup(grpc::ServerContext* context, const v1::DeleteBackupRequest* request,
                            google::protobuf::Empty* response) override;
  grpc::Status CompareBackup(grpc::ServerContext* context, const v1::CompareBackupRequest* request,
                             grpc::ServerWriter<v1::CompareBackupResponse>* stream) override;

 private:
  absl::Status CheckEnabled() const;

  CatalogueBackups* backups_;
};

}  // namespace graspdb::server
