// Numbers of records in sentences.
#pragma once

#include <string>

#include "absl/strings/str_cat.h"

namespace graspdb::client {

// "1 view", "2 views". The plural of `singular` ends in an s.
template <typename Number>
std::string Counted(Number count, const char* singular) {
  return absl::StrCat(count, " ", singular, count == 1 ? "" : "s");
}

}  // namespace graspdb::client
