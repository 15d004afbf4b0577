// Roles of calls, from the contract (graspdb/v1/authorization.proto).
#pragma once

#include <google/protobuf/descriptor.h>

#include <string>
#include <string_view>

#include "graspdb/v1/authorization.pb.h"
#include "graspdb/v1/identity.pb.h"

namespace graspdb::server {

// The method of a call to "/package.Service/Method"; null for one that is not in this program.
const google::protobuf::MethodDescriptor* FindMethod(std::string_view path);

// ROLE_UNSPECIFIED for a method without one.
v1::Role RoleOf(const google::protobuf::MethodDescriptor& method);

// Whether its calls are written to the audit log.
bool IsAudited(const google::protobuf::MethodDescriptor& method);

// Whether the identity may make calls that take `role`.
bool HasRole(const v1::Identity& identity, v1::Role role);

// "teach" for ROLE_TEACH.
std::string RoleName(v1::Role role);

}  // namespace graspdb::server
