// The header of a PLY file, parsed strictly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace graspdb::files {

// A PLY header.
struct PlyHeader {
  enum class Encoding { kAscii, kLittleEndian, kBigEndian };
  enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

  struct Property {
    std::string name;
    Type type = Type::kFloat32;  // of the value, or of the entries of the list
    bool is_list = false;
    Type length_type = Type::kUint8;  // of the number before the entries of a list
  };

  struct Element {
    std::string name;
    std::int64_t count = 0;
    std::vector<Property> properties;
  };

  Encoding encoding = Encoding::kAscii;
  std::vector<Element> elements;
  // Where the line of the first element that follows the format line begins, in bytes from the
  // start of the file; zero without such an element.
  std::size_t elements_offset = 0;
  // Where the body begins, in bytes from the start of the file.
  std::size_t body_offset = 0;
};

// Bytes of one value.
int SizeOf(PlyHeader::Type type);

// Reads the header at the start of `bytes`, the content of a file.
//
// INVALID_ARGUMENT with the first invalid line, without a path.
absl::StatusOr<PlyHeader> ParsePlyHeader(std::string_view bytes);

}  // namespace graspdb::files
