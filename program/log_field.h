// Values in the log: one line an event, `key=value` pairs (logfmt).
#pragma once

#include <string>
#include <string_view>

namespace graspdb {

// `value` as it can stand behind a key: quoted where it holds anything but plain
// characters, with quotes, backslashes and control characters escaped, so that what
// a caller sends cannot forge a line.
std::string LogField(std::string_view value);

}  // namespace graspdb
