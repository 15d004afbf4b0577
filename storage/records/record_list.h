// Reading records in the order of their names. Internal to storage/.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/status_macros.h"
#include "storage/database/database.h"
#include "storage/records/record_kind.h"
#include "storage/records/record_types.h"

namespace graspdb::storage {

// INVALID_ARGUMENT unless a page of `page_size` records after `after_name` of the
// collection with this prefix can be listed.
absl::Status CheckPage(std::size_t page_size, std::string_view prefix, std::string_view after_name);

// Bytes of records after which a page ends, whatever its requested size; it always has the first
// record. gRPC's clients accept responses of 4 MB by default, and a stable pose's outcomes, which
// are added to its record, can double it: they would reject twice as many.
inline constexpr std::size_t kMaxPageBytes = 1U << 20;

// Whether `page` ends before another record, with which it would have `bytes`.
template <typename Record>
bool EndsPage(std::size_t page_size, std::size_t bytes, Page<Record>* page) {
  const std::size_t count = page->records.size();
  page->more = count == page_size || (count > 0 && bytes > kMaxPageBytes);
  return page->more;
}

// A page of the collection of `parent_name` (empty for a collection without a parent).
template <typename Record>
absl::StatusOr<Page<Record>> ListRecords(const Database& database, std::string_view parent_name,
                                         std::size_t page_size, std::string_view after_name) {
  // It ends in '/', so objects/a does not match objects/ab.
  const std::string prefix = std::string(parent_name) + std::string(Kind<Record>::kCollection);
  RETURN_IF_ERROR(CheckPage(page_size, prefix, after_name));
  Page<Record> page;
  std::size_t bytes = 0;
  const absl::Status scanned =
      database.Scan(Kind<Record>::kFamily, prefix, after_name,
                    [&](std::string_view key, std::string_view value) -> absl::StatusOr<bool> {
                      bytes += value.size();
                      if (EndsPage(page_size, bytes, &page)) return false;
                      ASSIGN_OR_RETURN(auto record, ParseRecord<Record>(key, value));
                      page.records.push_back(std::move(record));
                      return true;
                    });
  if (!scanned.ok()) return scanned;
  return page;
}

// Visits all records of a kind as of `snapshot`.
template <typename Record>
absl::Status VisitRecords(const Database& database, const rocksdb::Snapshot* snapshot,
                          const std::function<absl::Status(const Record&)>& visit) {
  if (!visit) return absl::OkStatus();
  return database.Scan(
      Kind<Record>::kFamily, "", "",
      [&visit](std::string_view key, std::string_view value) -> absl::StatusOr<bool> {
        ASSIGN_OR_RETURN(const auto record, ParseRecord<Record>(key, value));
        RETURN_IF_ERROR(visit(record));
        return true;
      },
      snapshot);
}

}  // namespace graspdb::storage
