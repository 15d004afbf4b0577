#include "server/access/method_role.h"

#include <algorithm>

#include "absl/strings/ascii.h"

namespace graspdb::server {

const google::protobuf::MethodDescriptor* FindMethod(std::string_view path) {
  if (!path.starts_with('/')) return nullptr;
  std::string name(path.substr(1));
  std::ranges::replace(name, '/', '.');
  return google::protobuf::DescriptorPool::generated_pool()->FindMethodByName(name);
}

v1::Role RoleOf(const google::protobuf::MethodDescriptor& method) {
  return method.options().GetExtension(v1::role);
}

bool IsAudited(const google::protobuf::MethodDescriptor& method) {
  const v1::Role role = RoleOf(method);
  const bool only_looks = role == v1::ROLE_READ || role == v1::ROLE_RECOGNISE;
  return !only_looks || method.options().GetExtension(v1::audited);
}

bool HasRole(const v1::Identity& identity, v1::Role role) {
  return role != v1::ROLE_UNSPECIFIED && std::ranges::any_of(identity.roles(), [role](int own) {
           return own == role || own == v1::ROLE_ADMIN;
         });
}

std::string RoleName(v1::Role role) {
  return absl::AsciiStrToLower(v1::Role_Name(role).substr(sizeof("ROLE_") - 1));
}

}  // namespace graspdb::server
