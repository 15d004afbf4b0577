// Comparisons and imports of archives as text and JSON.
#pragma once

#include <google/protobuf/struct.pb.h>

#include <cstdint>
#include <string>

#include "client/archive/archive_import.h"

namespace graspdb::client {

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

// What an import did.
std::string ResultText(const ArchiveComparison& comparison, const ArchiveImportCounts& counts,
                       const v1::CatalogStatus& status);
google::protobuf::Struct ResultDocument(const files::ArchiveIndex& index,
                                        const ArchiveComparison& comparison,
                                        const ArchiveImportCounts& counts,
                                        const v1::CatalogStatus& status);

}  // namespace graspdb::client
