#include "storage/records/record_list.h"

namespace graspdb::storage {

absl::Status CheckPage(std::size_t page_size, std::string_view prefix,
                       std::string_view after_name) {
  if (page_size == 0) {
    return absl::InvalidArgumentError("the page size is 0; it must be at least 1");
  }
  if (after_name.empty() || after_name.starts_with(prefix)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "the page does not belong to this list; list again from the start");
}

}  // namespace graspdb::storage
