#include "files/points/ply_header.h"

#include <map>
#include <optional>

#include "absl/status/status.h"
#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "base/status_macros.h"
#include "program/text/text_encoding.h"

namespace graspdb::files {
namespace {

using Type = PlyHeader::Type;
using Words = std::vector<std::string>;

constexpr std::size_t kMaxHeaderBytes = std::size_t{64} * 1024;

std::optional<Type> TypeNamed(const std::string& name) {
  static const std::map<std::string, Type> types = {
      {"char", Type::kInt8},      {"int8", Type::kInt8},       {"uchar", Type::kUint8},
      {"uint8", Type::kUint8},    {"short", Type::kInt16},     {"int16", Type::kInt16},
      {"ushort", Type::kUint16},  {"uint16", Type::kUint16},   {"int", Type::kInt32},
      {"int32", Type::kInt32},    {"uint", Type::kUint32},     {"uint32", Type::kUint32},
      {"float", Type::kFloat32},  {"float32", Type::kFloat32}, {"double", Type::kFloat64},
      {"float64", Type::kFloat64}};
  const auto found = types.find(name);
  if (found == types.end()) return std::nullopt;
  return found->second;
}

bool IsInteger(Type type) { return type != Type::kFloat32 && type != Type::kFloat64; }

absl::Status ParseFormat(const Words& words, PlyHeader& header) {
  static const std::map<std::string, PlyHeader::Encoding> encodings = {
      {"ascii", PlyHeader::Encoding::kAscii},
      {"binary_little_endian", PlyHeader::Encoding::kLittleEndian},
      {"binary_big_endian", PlyHeader::Encoding::kBigEndian}};
  const auto found = words.size() == 3 ? encodings.find(words[1]) : encodings.end();
  if (found == encodings.end() || words[2] != "1.0") {
    return absl::InvalidArgumentError("its format line names no encoding of PLY 1.0");
  }
  header.encoding = found->second;
  return absl::OkStatus();
}

absl::Status ParseElement(const Words& words, PlyHeader& header) {
  PlyHeader::Element element;
  if (words.size() != 3 || !absl::SimpleAtoi(words[2], &element.count) || element.count < 0) {
    return absl::InvalidArgumentError("an element line does not give a name and a whole number");
  }
  element.name = words[1];
  header.elements.push_back(element);
  return absl::OkStatus();
}

absl::Status ParseProperty(const Words& words, PlyHeader& header) {
  if (header.elements.empty())
    return absl::InvalidArgumentError("a property line comes before the first element line");
  PlyHeader::Property property;
  property.is_list = words.size() == 5 && words[1] == "list";
  if (words.size() != 3 && !property.is_list)
    return absl::InvalidArgumentError("a property line gives no type and name");
  property.name = words.back();
  const std::optional<Type> type = TypeNamed(words[words.size() - 2]);
  const std::optional<Type> length = property.is_list ? TypeNamed(words[2]) : Type::kUint8;
  if (!type || !length || !IsInteger(*length)) {
    return absl::InvalidArgumentError("the property " + absl::CHexEscape(property.name) +
                                      " is of a type unknown to PLY");
  }
  property.type = *type;
  property.length_type = *length;
  header.elements.back().properties.push_back(property);
  return absl::OkStatus();
}

absl::Status ParseLine(const Words& words, PlyHeader& header) {
  if (words[0] == "comment" || words[0] == "obj_info") return absl::OkStatus();
  if (words[0] == "format") return ParseFormat(words, header);
  if (words[0] == "element") return ParseElement(words, header);
  if (words[0] == "property") return ParseProperty(words, header);
  return absl::InvalidArgumentError("its header has a line that begins with \"" +
                                    absl::CHexEscape(words[0].substr(0, 20)) + "\"");
}

}  // namespace

int SizeOf(Type type) {
  switch (type) {
    case Type::kInt8:
    case Type::kUint8:
      return 1;
    case Type::kInt16:
    case Type::kUint16:
      return 2;
    case Type::kInt32:
    case Type::kUint32:
    case Type::kFloat32:
      return 4;
    case Type::kFloat64:
      return 8;
  }
  return 0;
}

absl::StatusOr<PlyHeader> ParsePlyHeader(std::string_view bytes) {
  PlyHeader header;
  bool has_format = false;
  std::size_t begin = 0;
  for (int number = 1; begin < kMaxHeaderBytes; ++number) {
    const std::size_t end = bytes.find('\n', begin);
    if (end == std::string_view::npos) break;
    std::string line(bytes.substr(begin, end - begin));
    RETURN_IF_ERROR(number == 1 ? TakeUtf8("its header", &line) : absl::OkStatus());
    const Words words = absl::StrSplit(line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
    const std::size_t line_offset = begin;
    begin = end + 1;
    if (number == 1) {
      if (words != Words{"ply"})
        return absl::InvalidArgumentError("it is not a PLY file, as its first line is not \"ply\"");
      continue;
    }
    if (words.empty()) continue;
    if (words[0] == "end_header") {
      if (!has_format) return absl::InvalidArgumentError("its header has no format line");
      header.body_offset = begin;
      return header;
    }
    if (has_format && words[0] == "element" && header.elements_offset == 0) {
      header.elements_offset = line_offset;
    }
    has_format |= words[0] == "format";
    RETURN_IF_ERROR(ParseLine(words, header));
  }
  return absl::InvalidArgumentError(
      "it is not a whole PLY file, as no end_header line ends its header");
}

}  // namespace graspdb::files
