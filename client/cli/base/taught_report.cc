#include "client/cli/base/taught_report.h"

#include <cstdio>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cli/base/counted.h"

namespace graspdb::client {

absl::StatusOr<v1::CatalogStatus> ReportTaught(const GlobalOptions& global, Client& client,
                                               const TaughtViews& views, const std::string& rest) {
  ASSIGN_OR_RETURN(v1::CatalogStatus status, client.GetCatalogStatus());
  if (global.json) {
    v1::UploadViewsResponse summary;
    summary.set_created_count(views.created);
    summary.set_existing_count(views.existing.value_or(0));
    summary.set_catalog_revision(status.catalog_revision());
    RETURN_IF_ERROR(PrintJson(summary));
    return status;
  }
  const std::string existing =
      views.existing ? absl::StrCat(", ", *views.existing, " were there already") : "";
  std::printf("taught %s%s; the catalogue has %s of %s%s\n", Counted(views.created, "view").c_str(),
              existing.c_str(), Counted(status.view_count(), "view").c_str(),
              Counted(status.object_count(), "object").c_str(), rest.c_str());
  return status;
}

}  // namespace graspdb::client
