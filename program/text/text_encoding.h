// The encoding of text files that people edit.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace graspdb {

// Of UTF-8, with which editors of Windows begin a file.
inline constexpr absl::string_view kByteOrderMark = "\xEF\xBB\xBF";

// Removes the byte order mark before `text`, the content of the file `name`; it is no part of the
// first word.
//
// INVALID_ARGUMENT, with the name and what to do, when the text is in UTF-16 or UTF-32, which a
// reader of UTF-8 would take for single letters between zeros.
absl::Status TakeUtf8(absl::string_view name, std::string* text);

}  // namespace graspdb
