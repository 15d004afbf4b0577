// The methods of the contract that browsers may call: all of the package graspdb.v1.
#pragma once

#include <google/protobuf/descriptor.h>

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "console/connect_protocol.h"

namespace graspdb::console {

// The method with this path, "/graspdb.v1.CatalogService/GetObject"; null if there is none.
// Thread-safe.
const google::protobuf::MethodDescriptor* FindMethod(std::string_view path);

// The path of every method, by name.
std::vector<std::string> MethodPaths();

// The message of a request as the server takes it. INVALID_ARGUMENT for JSON that does not fit it,
// also for an unknown field. Of binary messages nothing is checked: the server does that. Takes as
// long as protobuf's parser; nested at most 100 deep.
absl::StatusOr<std::string> RequestBytes(const google::protobuf::MethodDescriptor& method,
                                         Encoding encoding, std::string message);

// The message of a response as the caller takes it. INTERNAL where a server's message has no JSON.
absl::StatusOr<std::string> ResponseText(const google::protobuf::MethodDescriptor& method,
                                         Encoding encoding, std::string message);

}  // namespace graspdb::console
