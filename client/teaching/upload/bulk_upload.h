// Teaches many views by a bulk upload of the server: all of them become part of the catalogue
// together. An interrupted upload goes on where it stood.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/sdk/client.h"
#include "client/teaching/upload/view_upload.h"

namespace graspdb::client {

struct BulkUploadOptions {
  // Id of the upload. An open upload with this id is continued; choose it from what is uploaded.
  std::string upload_id;
  // Streams that send at the same time. The server computes on as many cores; more would only wait.
  int streams = 4;
  // Whether one view that cannot be taught keeps all others out of the catalogue, too.
  bool atomic = false;
};

// A view that could not be taught.
struct FailedView {
  std::size_t index = 0;  // of ViewsToTeach
  absl::Status error;
};

struct BulkUploadResult {
  UploadCounts counts;
  std::vector<FailedView> failed;  // by index
};

// What an upload would do.
struct UploadPlan {
  std::size_t new_count = 0;
  std::size_t existing_count = 0;  // in the catalogue already
  std::size_t staged_count = 0;    // sent before, by an upload that was interrupted
  std::size_t repeated_count = 0;  // the same as a new one before, which becomes one view with it
  std::vector<FailedView> unreadable;
};

// Teaches the views. `views.make` is called from several threads. Views that cannot be read or
// taught are in the result; with `atomic` they are FAILED_PRECONDITION, and nothing is committed.
// Views that a busy server refuses are sent again, until it takes none for Client::busy_retries()
// attempts. CANCELLED when the watch requests it, also meanwhile; errors of the server. After an
// error, the same call continues.
absl::StatusOr<BulkUploadResult> TeachInBulk(Client& client, const ViewsToTeach& views,
                                             const BulkUploadOptions& options,
                                             const UploadWatch& watch);

// Reads all views, and compares them with the catalogue and the interrupted upload; sends nothing.
absl::StatusOr<UploadPlan> PlanUpload(Client& client, const ViewsToTeach& views,
                                      const std::string& upload_id, const UploadWatch& watch);

}  // namespace graspdb::client
