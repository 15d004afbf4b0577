// ChangeService over the storage.
#pragma once

#include <atomic>

#include "graspdb/v1/change_service.grpc.pb.h"
#include "server/live/live_catalogue.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// Thread-safe.
class ChangeService final : public v1::ChangeService::Service {
 public:
  // Both references must outlive this. Each watcher has a thread of the server.
  ChangeService(const storage::Catalogue& catalogue, const LiveCatalogue& live, int max_watchers)
      : catalogue_(catalogue), live_(live), max_watchers_(max_watchers) {}

  // Ends the calls within half a second, so that a shutdown need not wait for them.
  void Stop() { stopping_ = true; }

  using Writer = grpc::ServerWriter<v1::WatchCatalogResponse>;
  grpc::Status WatchCatalog(grpc::ServerContext* context, const v1::WatchCatalogRequest* request,
                            Writer* writer) override;

 private:
  absl::Status Watch(const grpc::ServerContext& context, const v1::WatchCatalogRequest& request,
                     Writer& writer) const;
  // Sends the changes after `*revision`, and advances it.
  absl::Status SendChanges(bool include_records, std::int64_t* revision, Writer& writer) const;

  const storage::Catalogue& catalogue_;
  const LiveCatalogue& live_;
  const int max_watchers_;
  std::atomic<int> watchers_ = 0;
  std::atomic<bool> stopping_ = false;
};

}  // namespace graspdb::server
