#include "client/cli/objects/taught_report.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cli/base/counted.h"
#include "client/teaching/turntable/look_alikes_text.h"

namespace graspdb::client {
namespace {

// Catalogues of up to this many stable poses are compared after an import.
constexpr int kCheckedStablePoses = 100;
constexpr std::size_t kShownNotes = 5;

}  // namespace

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

absl::Status NoteLookAlikes(Client& client, const std::string& object,
                            const v1::CatalogStatus& status) {
  if (status.stable_pose_count() > kCheckedStablePoses) {
    std::fprintf(stderr, "note: find look-alikes with: graspdb objects check\n");
    return absl::OkStatus();
  }
  ASSIGN_OR_RETURN(const auto found, client.FindLookAlikes(object));
  const std::vector<std::string> notes = LookAlikesText(found, /*nearly_too=*/false);
  for (std::size_t i = 0; i < std::min(notes.size(), kShownNotes); ++i) {
    std::fprintf(stderr, "note: %s\n", notes[i].c_str());
  }
  if (notes.size() > kShownNotes) {
    std::fprintf(stderr, "note: %zu more; see all with: graspdb objects check\n",
                 notes.size() - kShownNotes);
  }
  return absl::OkStatus();
}

}  // namespace graspdb::client
