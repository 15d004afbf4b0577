// What came of teaching.
#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/cli/base/command.h"

namespace graspdb::client {

struct TaughtViews {
  int created = 0;
  std::optional<int> existing = {};  // were there already, where that is known
};

// Prints how many views were taught and how many the catalogue has now, as text, with `rest` at the
// end, or as JSON; and gives the state of the catalogue. Errors of Client::GetCatalogStatus.
absl::StatusOr<v1::CatalogStatus> ReportTaught(const GlobalOptions& global, Client& client,
                                               const TaughtViews& views,
                                               const std::string& rest = "");

}  // namespace graspdb::client
