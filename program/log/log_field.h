// Values in the log: one line per event, `key=value` pairs (logfmt).
#pragma once

#include <string>
#include <string_view>

namespace graspdb {

// `value` as the value of a key: quoted if it has other than plain characters, with
// quotes, backslashes and control characters escaped, so that the input of a caller
// cannot forge a line.
std::string LogField(std::string_view value);

}  // namespace graspdb
