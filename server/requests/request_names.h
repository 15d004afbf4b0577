// The resource names in requests.
#pragma once

#include <google/protobuf/message.h>

#include <optional>
#include <string>

namespace graspdb::server {

// The name of the resource that the request reads or changes: its `name`, the `name` of the
// resource in an update, the name made of `parent` and id in a creation, or its `cell`; else empty.
std::string ResourceOf(const google::protobuf::Message& request);

// The name of the cell that the request uses or changes, empty if the field for it is empty;
// nullopt for a request without a cell.
std::optional<std::string> CellOf(const google::protobuf::Message& request);

}  // namespace graspdb::server
