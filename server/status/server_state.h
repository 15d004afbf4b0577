// The state of a server beside its catalogue, for status requests.
#pragma once

#include <string>

#include "graspdb/v1/server_state.pb.h"
#include "server/access/file_state.h"
#include "server/backups/catalogue_backups.h"
#include "server/calls/call_guard.h"
#include "server/live/live_catalogue.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

struct ServerStateSources {
  const storage::Catalogue& catalogue;
  const LiveCatalogue& live;
  const AccessRules& access;
  const FileState& tls_files;
  std::string certificate;          // file; empty: no TLS
  const CatalogueBackups* backups;  // null: there is no folder for them
};

// Reads the certificate and the free space from the disk: some 0.1 ms. Thread-safe.
v1::ServerState ServerStateOf(const ServerStateSources& from);

}  // namespace graspdb::server
