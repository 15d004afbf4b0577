// GetCatalogStatus of CatalogService.
#include <chrono>
#include <string>

#include "program/version.h"
#include "server/calls/handle.h"
#include "server/catalogue/catalog_service.h"
#include "server/catalogue/grasp_outcomes.h"

namespace graspdb::server {
namespace {

v1::CacheStatus UseToProto(const CacheUse& use) {
  v1::CacheStatus out;
  out.set_hit_count(use.hits);
  out.set_miss_count(use.misses);
  out.set_rejected_count(use.rejected);
  out.set_byte_count(static_cast<std::int64_t>(use.bytes));
  out.set_byte_budget(static_cast<std::int64_t>(use.byte_budget));
  return out;
}

v1::MemoryStatus MemoryToProto(const CatalogContext& context) {
  v1::MemoryStatus out;
  const RequestMemory::Use use = context.request_memory.use();
  out.set_byte_budget(static_cast<std::int64_t>(context.memory.total));
  out.set_cache_byte_budget(static_cast<std::int64_t>(context.memory.caches));
  out.set_request_byte_budget(static_cast<std::int64_t>(context.memory.requests));
  out.set_request_byte_count(static_cast<std::int64_t>(use.bytes));
  out.set_refused_request_count(use.refused);
  out.set_resident_byte_count(static_cast<std::int64_t>(ResidentBytes()));
  return out;
}

}  // namespace

grpc::Status CatalogService::GetCatalogStatus(grpc::ServerContext* context,
                                              const v1::GetCatalogStatusRequest* request,
                                              v1::CatalogStatus* response) {
  return Handle(*context, "GetCatalogStatus", *request, [&] {
    const storage::CatalogueCounts counts = context_.catalogue.counts();
    response->set_catalog_id(context_.catalogue.id());
    response->set_catalog_revision(context_.catalogue.revision());
    response->set_object_count(counts.objects);
    response->set_stable_pose_count(counts.stable_poses);
    response->set_view_count(counts.views);
    response->set_left_out_record_count(context_.live.left_out_count());
    response->set_server_version(kVersion);
    const std::chrono::duration<double> uptime = std::chrono::steady_clock::now() - start_;
    response->set_uptime_s(uptime.count());
    response->set_descriptor_name(
        std::string(recognition::DescriptorName(context_.parameters.descriptor.kind)));
    response->set_schema_version(context_.catalogue.schema_version());
    *response->mutable_model_cache() = UseToProto(context_.clouds.model_use());
    *response->mutable_cloud_cache() = UseToProto(context_.clouds.cloud_use());
    *response->mutable_memory() = MemoryToProto(context_);
    if (context_.backups != nullptr) *response->mutable_backup() = context_.backups->Status();
    if (context_.server_state) *response->mutable_server_state() = context_.server_state();
    // When revocations or audit records are without effect is for operators only.
    if (const CallGuard* guard = CallGuard::Of(*context); guard != nullptr && !guard->operates()) {
      response->mutable_server_state()->clear_file_faults();
      response->mutable_server_state()->clear_lost_audit_record_count();
    }
    return SumGraspOutcomes(context_.catalogue, response);
  });
}

}  // namespace graspdb::server
