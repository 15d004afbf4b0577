// Writes a catalogue, or some objects of it, into an archive.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/sdk/client.h"
#include "graspdb/v1/archive.pb.h"

namespace graspdb::client {

// Both callbacks are optional.
struct ExportWatch {
  std::function<void(std::int64_t done, std::int64_t total)> report;  // views
  std::function<bool()> cancelled;
};

struct ExportResult {
  v1::ArchiveHeader header;
  v1::ArchiveEnd end;
};

// Writes the objects of these resource names (all without names) with their stable poses, views and
// clouds. The memory is that of the objects, of the list of one stable pose's views, and of four
// views with clouds. The same catalogue gives the same bytes, as long as its revision is the same.
//
// NOT_FOUND for an object that does not exist; ABORTED when the catalogue changed so that the file
// would be incomplete; CANCELLED when the watch requests it; ALREADY_EXISTS where there is a file
// at the path, also if it was made meanwhile; errors of the server and of WriteFileAtomically. An
// error leaves the path as it was.
absl::StatusOr<ExportResult> ExportArchive(Client& client, std::vector<std::string> objects,
                                           const std::filesystem::path& path,
                                           const ExportWatch& watch);

}  // namespace graspdb::client
