// `export` and `import` of archives.
#pragma once

#include <google/protobuf/struct.pb.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "client/archive/archive_import.h"
#include "client/cli/base/command.h"

namespace graspdb::client {

// Whether the argument of `import` or `export` is an archive, and not the folder of a capture set:
// a file, or a name that ends as archives do.
bool IsArchivePath(const std::filesystem::path& path);

// Writes the objects of these ids, all without, to the file, which must not exist.
absl::Status RunArchiveExport(const GlobalOptions& global, const std::string& path,
                              const std::vector<std::string>& object_ids);

struct ArchiveImportFlags {
  std::string path;
  std::string base = {};  // path of another archive; empty: none
  std::vector<std::string> objects = {};
  std::string on_conflict = "fail";
  bool no_outcomes = false;
  bool resume = false;
  bool dry_run = false;
};

// The values of --on-conflict.
std::vector<std::string> OnConflictNames();

// Reads the whole file, compares it with the server, prints the comparison, and imports it.
absl::Status RunArchiveImport(const GlobalOptions& global, const ArchiveImportFlags& flags);

// Records of a kind that are created or replaced.
std::int64_t CountOf(const files::ArchiveIndex& index, const ArchiveComparison& comparison,
                     files::ArchiveKind kind);

// A table of kinds and states, then DifferencesText() and notes.
std::string ComparisonText(const files::ArchiveIndex& index, const ArchiveComparison& comparison);
// A line for each of the first records that the server has with other content.
std::string DifferencesText(const files::ArchiveIndex& index, const ArchiveComparison& comparison);
// All of it.
google::protobuf::Struct ComparisonDocument(const files::ArchiveIndex& index,
                                            const ArchiveComparison& comparison);

}  // namespace graspdb::client
