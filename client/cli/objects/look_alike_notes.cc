#include "client/cli/objects/look_alike_notes.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "base/status_macros.h"
#include "client/teaching/turntable/look_alikes_text.h"

namespace graspdb::client {
namespace {

// Catalogues of up to this many stable poses are compared after an import.
constexpr int kCheckedStablePoses = 100;
constexpr std::size_t kShownNotes = 5;

}  // namespace

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
