// What `graspdb doctor` looks for in a server beside its catalogue. Pure functions.
#pragma once

#include <string_view>

#include "absl/time/time.h"
#include "client/cli/objects/doctor_finding.h"
#include "graspdb/v1/catalog_service.pb.h"

namespace graspdb::client {

// Backups that fail, are missing or old.
void CheckBackups(const v1::CatalogStatus& status, Findings* out);

// Space on the disks of the database and of the backups.
void CheckDisks(const v1::CatalogStatus& status, Findings* out);

// Changes that the server rejects since its disk fails or is full.
void CheckWrites(const v1::ServerState& state, Findings* out);

// Files of the database that are missing or damaged.
void CheckDatabaseFiles(const v1::ServerState& state, Findings* out);

// Files of the settings that cannot be used, and audit records that are lost.
void CheckFiles(const v1::ServerState& state, Findings* out);

// The certificate of that flag, which expires at `end`. `subject` is "server" or "client".
void CheckCertificate(std::string_view subject, std::string_view flag, absl::Time end,
                      absl::Time now, Findings* out);

// The server's clock against this machine's, whose times are those before and after the call.
void CheckClock(const v1::ServerState& state, absl::Time before, absl::Time after, Findings* out);

// Whether the index has the changes of the catalogue: those of the status `first` in the status
// `later`, as a change of the moment is not in it yet.
void CheckIndex(const v1::CatalogStatus& first, const v1::CatalogStatus& later, Findings* out);

}  // namespace graspdb::client
