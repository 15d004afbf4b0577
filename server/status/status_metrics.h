// Metrics of the server's state, read when they are collected.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "program/connections/connection_acceptor.h"
#include "program/metrics/families.h"
#include "program/metrics/metrics_server.h"
#include "server/access/file_state.h"
#include "server/backups/catalogue_backups.h"
#include "server/calls/admission.h"
#include "server/calls/call_guard.h"
#include "server/calls/call_metrics.h"
#include "server/calls/memory_budget.h"
#include "server/live/live_catalogue.h"
#include "server/live/view_cloud_cache.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

struct StatusSources {
  storage::Catalogue& catalogue;
  const LiveCatalogue& live;
  const ViewCloudCache& clouds;
  const RequestMemory& request_memory;
  MemoryShares memory;
  const ConnectionAcceptor& acceptor;
  const Admission& recognizing;
  const Admission& teaching;
  const Admission& uploading;
  const CatalogueBackups* backups;  // null: there is no folder for them
  const AccessRules& access;
  const FileState& tls_files;
  std::string certificate;         // file; empty: no TLS
  absl::Time start = absl::Now();  // of the server
};

// Serves the metrics of `sources`, without waiting for a change of the catalogue, and of `calls`,
// which must outlive the result, as MetricsServer::Start. Reads the records of bulk uploads and the
// certificate from the disk each time.
absl::StatusOr<std::unique_ptr<MetricsServer>> ServeMetrics(const MetricsOptions& options,
                                                            const StatusSources& sources,
                                                            const CallMetrics* calls);

}  // namespace graspdb::server
