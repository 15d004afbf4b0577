// The result of teaching.
#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/cli/base/command.h"

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

}  // namespace graspdb::client
