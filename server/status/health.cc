#include "server/status/health.h"

#include <grpcpp/health_check_service_interface.h>

namespace graspdb::server {

Health::Health(LiveCatalogue& live, grpc::Server& server) : live_(live), server_(server) {
  live_.ReportAgreement([health = server_.GetHealthCheckService()](bool agrees) {
    // Of the whole server alone: without a name it would be that of graspdb.writes as well.
    health->SetServingStatus("", agrees);
  });
}

Health::~Health() { live_.ReportAgreement({}); }

void Health::Drain() { server_.GetHealthCheckService()->Shutdown(); }

}  // namespace graspdb::server
