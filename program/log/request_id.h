// Ids of calls: the metadata x-request-id, which is in the logs of both sides and in bundles.
#pragma once

#include <string>
#include <string_view>

namespace graspdb {

inline constexpr char kRequestIdKey[] = "x-request-id";

// Whether `id` can be used as it is: 1 to 64 letters, digits, '-', '_' and '.', so that it needs no
// quotes in a log line.
bool IsRequestId(std::string_view id);

// A new one: 16 hexadecimal digits, random. Thread-safe.
std::string MakeRequestId();

}  // namespace graspdb
