// Imports an archive into a server's catalogue.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/archive/archive_comparison.h"
#include "client/sdk/client.h"
#include "client/teaching/upload/bulk_upload.h"

namespace graspdb::client {

struct ArchiveImportOptions {
  // Whether counts of reported picks that are lower on the server are raised to those of the file.
  bool outcomes = true;
};

struct ArchiveImportCounts {
  std::int64_t created_objects = 0;
  std::int64_t created_stable_poses = 0;
  std::int64_t created_views = 0;
  std::int64_t replaced = 0;         // objects, stable poses and views
  std::int64_t raised_outcomes = 0;  // stable poses
};

// The ids of the bulk uploads of an import, most often one: each has as many views as the contract
// allows. The same file with the same decisions has the same ids, so that an interrupted import is
// continued.
std::vector<std::string> UploadIdsOf(const files::ArchiveIndex& index,
                                     const ArchiveComparison& comparison);

// Does what the comparison decided: creates objects and stable poses, which recognition does not
// use without views; publishes all views in one revision (each 100,000), or none; replaces objects
// and stable poses; raises the counts of picks. Deletes nothing. The watch counts views.
//
// Whether undecided conflicts are an error is for the caller to decide, before this: conflicts that
// are not replaced stay as they are on the server. ABORTED when an object or a stable pose was
// changed since the comparison, or a view taught under the name of a new one; not so where any view
// is replaced: then all views of these names are, whatever they are by then. CANCELLED; errors of
// TeachInBulk and of the server. After an error, comparing and importing again goes on where it
// stood.
absl::StatusOr<ArchiveImportCounts> ImportArchive(Client& client, const OpenArchive& archive,
                                                  const ArchiveComparison& comparison,
                                                  const ArchiveImportOptions& options,
                                                  const UploadWatch& watch);

}  // namespace graspdb::client
