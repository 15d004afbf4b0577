// Keys of JSON that people edit.
#pragma once

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace graspdb {

// INVALID_ARGUMENT, with key and line, when an object of `text`, which is JSON, has a key twice:
// parsers take the last one in silence, although the first may be what its author reads. Takes
// n log n.
absl::Status CheckJsonKeys(absl::string_view text);

}  // namespace graspdb
