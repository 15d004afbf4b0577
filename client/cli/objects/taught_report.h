// What is reported after teaching: the number of views, and look-alikes.
#pragma once

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/cli/base/command.h"
#include "client/sdk/client.h"

namespace graspdb::client {

struct TaughtViews {
  int created = 0;
  std::optional<int> existing = {};  // already in the catalogue, where known
};

// Prints the number of taught views and of views in the catalogue, as text, with `rest` at the end,
// or as JSON; returns the status of the catalogue. Errors of Client::GetCatalogStatus.
absl::StatusOr<v1::CatalogStatus> ReportTaught(const GlobalOptions& global, Client& client,
                                               const TaughtViews& views,
                                               const std::string& rest = "");

// Prints the look-alikes of the object with this resource name on stderr; of all objects if "". If
// the catalogue (see `status`) is large, prints only the command that compares it. Errors of
// Client::FindLookAlikes.
absl::Status NoteLookAlikes(Client& client, const std::string& object,
                            const v1::CatalogStatus& status);

}  // namespace graspdb::client
