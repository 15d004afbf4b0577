// The facets of STL files.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace graspdb::rendering {

// `bytes`, the content of a binary or ascii STL file, as a binary one with the facets of all its
// solids. Keywords may be in upper case, as the format has them in either. A file whose size is
// that of its facets is binary, however it begins.
//
// INVALID_ARGUMENT, without a path, for a file that is cut short or longer than its facets, and
// with the number of the first invalid line of text.
absl::StatusOr<std::string> BinaryStl(std::string_view bytes);

bool IsBinaryStl(std::string_view bytes);

// The text in which the program that wrote `bytes` may have described them: the names of solids, or
// the header of a binary file.
std::string StlDescription(std::string_view bytes);

}  // namespace graspdb::rendering
