// Conversion of a StatusOr to a response, and pages of lists (AIP-158).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/statusor.h"
#include "base/status_macros.h"
#include "server/base/errors.h"
#include "server/requests/request_limits.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// 0 means 100, more than 1000 means 1000; negative is INVALID_ARGUMENT.
absl::StatusOr<std::size_t> PageSize(std::int32_t requested);

// The token for the page after `last_name`, and back. INVALID_ARGUMENT for a token
// that is not from a list of names with this prefix.
std::string PageTokenAfter(std::string_view last_name);
absl::StatusOr<std::string> NameFromPageToken(std::string_view token, std::string_view prefix);

// A record for a response: one that was stored before the limits existed may exceed the size of a
// response.
template <typename T>
T Answerable(T record) {
  if constexpr (requires { record.display_name(); }) {
    record.DiscardUnknownFields();
    if (record.display_name().size() > kMaxNameBytes) {
      record.set_display_name(BoundedText(record.display_name(), kMaxNameBytes));
    }
  }
  return record;
}

// Moves the value into the response, or returns the error, with the field `path` if it
// is an invalid name.
template <typename T>
absl::Status Respond(std::string_view path, absl::StatusOr<T> result, T* response) {
  if (!result.ok()) return AtField(path, result.status());
  *response = Answerable(*std::move(result));
  return absl::OkStatus();
}

// Lists a page: `list(page_size, after_name)` returns the records, whose names begin with
// `prefix`, `add(record)` adds one to the response.
template <typename Request, typename Response, typename List, typename Add>
absl::Status RespondPage(const Request& request, const std::string& prefix, List&& list, Add&& add,
                         Response* response) {
  ASSIGN_OR_RETURN(std::size_t size, PageSize(request.page_size()));
  ASSIGN_OR_RETURN(std::string after, NameFromPageToken(request.page_token(), prefix));
  auto page = list(size, after);
  if (!page.ok()) return AtField("parent", page.status());
  if (page->more) response->set_next_page_token(PageTokenAfter(page->records.back().name()));
  for (auto& record : page->records) add(Answerable(std::move(record)));
  return absl::OkStatus();
}

}  // namespace graspdb::server
