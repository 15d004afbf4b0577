// The vertices and faces of OBJ files.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace graspdb::rendering {

// `text`, the content of an OBJ file, with nothing but its vertices and faces, one a line, without
// continued lines. assimp takes a line that ends in a backslash for continued where it is not, as a
// comment or a name (github.com/assimp/assimp/issues/3532), and then drops a vertex.
//
// INVALID_ARGUMENT with the number of the first invalid line, without a path: a vertex that is not
// of finite numbers, a face with fewer than three corners or one that does not exist, a curved
// surface, a line longer than 1 MiB.
absl::StatusOr<std::string> PlainObj(std::string_view text);

}  // namespace graspdb::rendering
