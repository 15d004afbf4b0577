// A server in the process, with a database in memory.
#pragma once

#include <memory>

#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "graspdb/v1/cell_service.grpc.pb.h"
#include "graspdb/v1/object_history_service.grpc.pb.h"
#include "graspdb/v1/recognition_service.grpc.pb.h"
#include "graspdb/v1/upload_service.grpc.pb.h"
#include "server/server.h"
#include "tests/fuzz/scratch_folder.h"

namespace graspdb::fuzz {

// More points than any input has; a frame with more is rejected, like with the default limit.
inline constexpr int kMaxPoints = 20'000;

class FuzzServer {
 public:
  // Silences the log of the process.
  FuzzServer();

  // Ends the server and starts it over the same database, or over a new one.
  void Restart();
  void StartAnew();
  // Ends the server; the database stays.
  void Stop() { server_.reset(); }

  std::string database() const { return (folder_.path() / "db").string(); }

  v1::CatalogService::Stub& catalog() { return *catalog_; }
  v1::CellService::Stub& cells() { return *cells_; }
  v1::RecognitionService::Stub& recognition() { return *recognition_; }
  v1::UploadService::Stub& uploads() { return *uploads_; }
  v1::ObjectHistoryService::Stub& history() { return *history_; }

  // Makes the object and its stable pose "flat", with two grasps.
  void Declare(const std::string& object_id);
  grpc::Status Upload(const google::protobuf::RepeatedPtrField<v1::UploadViewsRequest>& views,
                      v1::UploadViewsResponse* response);
  // Two parts of four views each, one of them with object poses.
  void TeachParts();

 private:
  const ScratchFolder folder_;
  std::unique_ptr<server::Server> server_;
  std::unique_ptr<v1::CatalogService::Stub> catalog_;
  std::unique_ptr<v1::CellService::Stub> cells_;
  std::unique_ptr<v1::RecognitionService::Stub> recognition_;
  std::unique_ptr<v1::UploadService::Stub> uploads_;
  std::unique_ptr<v1::ObjectHistoryService::Stub> history_;
};

// Two distinguishable parts.
inline constexpr char kFusedPart[] = "l-bracket";
inline constexpr char kLoosePart[] = "stepped-block";

}  // namespace graspdb::fuzz
