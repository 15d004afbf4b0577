#include "files/ply_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "absl/status/status.h"
#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "files/ply_header.h"

namespace graspdb::client {
namespace {

using Type = PlyHeader::Type;

constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{4} << 30;
constexpr double kMaxListLength = 4294967295;  // of a uint
static_assert(std::endian::native == std::endian::little);

// Reads the numbers of a body one by one, in any encoding.
class Body {
 public:
  Body(std::string_view bytes, PlyHeader::Encoding encoding)
      : bytes_(bytes), encoding_(encoding), total_(bytes.size()) {}

  // Empty when the body ends first or a word is not a number.
  std::optional<double> Next(Type type) {
    return encoding_ == PlyHeader::Encoding::kAscii ? NextWord() : NextBinary(type);
  }

  // The reason why Next failed.
  std::string Trouble() const {
    if (!bad_word_.empty()) {
      return absl::StrCat("\"", absl::CHexEscape(bad_word_), "\" stands where a number belongs");
    }
    return absl::StrCat("its body ends after ", total_, " bytes, before all declared elements");
  }

 private:
  std::optional<double> NextWord() {
    constexpr std::string_view kSpaces = " \t\r\n";
    bytes_.remove_prefix(std::min(bytes_.find_first_not_of(kSpaces), bytes_.size()));
    if (bytes_.empty()) return std::nullopt;
    const std::string_view word = bytes_.substr(0, bytes_.find_first_of(kSpaces));
    bytes_.remove_prefix(word.size());
    double value = 0;
    if (absl::SimpleAtod(absl::string_view(word.data(), word.size()), &value)) return value;
    bad_word_ = std::string(word.substr(0, 20));
    return std::nullopt;
  }

  template <typename T>
  static double As(const std::array<char, 8>& raw) {
    T value{};
    std::memcpy(&value, raw.data(), sizeof(value));
    return static_cast<double>(value);
  }

  std::optional<double> NextBinary(Type type) {
    const auto size = static_cast<std::size_t>(SizeOf(type));
    if (bytes_.size() < size) return std::nullopt;
    std::array<char, 8> raw{};
    bytes_.copy(raw.data(), size);
    bytes_.remove_prefix(size);
    if (encoding_ == PlyHeader::Encoding::kBigEndian) {
      std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
    }
    switch (type) {
      case Type::kInt8:
        return As<std::int8_t>(raw);
      case Type::kUint8:
        return As<std::uint8_t>(raw);
      case Type::kInt16:
        return As<std::int16_t>(raw);
      case Type::kUint16:
        return As<std::uint16_t>(raw);
      case Type::kInt32:
        return As<std::int32_t>(raw);
      case Type::kUint32:
        return As<std::uint32_t>(raw);
      case Type::kFloat32:
        return As<float>(raw);
      case Type::kFloat64:
        return As<double>(raw);
    }
    return std::nullopt;
  }

  std::string_view bytes_;
  PlyHeader::Encoding encoding_;
  std::size_t total_;
  std::string bad_word_;
};

// Skips one instance of an element; a list is bounded by the body.
bool Skip(const PlyHeader::Element& element, Body& body) {
  for (const PlyHeader::Property& property : element.properties) {
    std::int64_t values = 1;
    if (property.is_list) {
      const std::optional<double> length = body.Next(property.length_type);
      if (!length || !(*length >= 0 && *length <= kMaxListLength)) return false;
      values = static_cast<std::int64_t>(*length);
    }
    for (std::int64_t i = 0; i < values; ++i) {
      if (!body.Next(property.type)) return false;
    }
  }
  return true;
}

// Positions of the named properties; empty unless all exist as float or double.
std::optional<std::array<std::size_t, 3>> FindColumns(const PlyHeader::Element& vertex,
                                                      std::array<std::string_view, 3> names) {
  std::array<std::size_t, 3> columns{};
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto found = std::find_if(
        vertex.properties.begin(), vertex.properties.end(), [&](const PlyHeader::Property& p) {
          return p.name == names[k] && (p.type == Type::kFloat32 || p.type == Type::kFloat64);
        });
    if (found == vertex.properties.end()) return std::nullopt;
    columns[k] = static_cast<std::size_t>(found - vertex.properties.begin());
  }
  return columns;
}

absl::Status CheckVertex(const PlyHeader::Element& vertex) {
  if (vertex.count == 0) return absl::InvalidArgumentError("it has no points");
  if (vertex.count > kMaxPoints) {
    return absl::InvalidArgumentError(absl::StrCat("its header promises ", vertex.count,
                                                   " points; at most ", kMaxPoints, " are read"));
  }
  const auto is_list = [](const PlyHeader::Property& p) { return p.is_list; };
  if (std::any_of(vertex.properties.begin(), vertex.properties.end(), is_list)) {
    return absl::InvalidArgumentError("its vertices have a list property");
  }
  if (!FindColumns(vertex, {"x", "y", "z"})) {
    return absl::InvalidArgumentError("its vertices have no x, y and z of type float or double");
  }
  return absl::OkStatus();
}

absl::StatusOr<PointFile> ReadVertices(const PlyHeader::Element& vertex, Body& body) {
  const auto points = FindColumns(vertex, {"x", "y", "z"});
  auto normals = FindColumns(vertex, {"nx", "ny", "nz"});
  if (!normals) normals = FindColumns(vertex, {"normal_x", "normal_y", "normal_z"});
  PointFile file;
  file.width = static_cast<int>(vertex.count);
  file.height = 1;
  std::vector<float> row(vertex.properties.size());
  const auto pick = [&row](const std::array<std::size_t, 3>& columns) {
    return Eigen::Vector3f(row[columns[0]], row[columns[1]], row[columns[2]]);
  };
  for (std::int64_t i = 0; i < vertex.count; ++i) {
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::optional<double> value = body.Next(vertex.properties[k].type);
      if (!value)
        return absl::InvalidArgumentError(absl::StrCat("at point ", i + 1, ", ", body.Trouble()));
      // Values beyond single precision count as no measurement.
      const bool fits = std::abs(*value) <= std::numeric_limits<float>::max();
      row[k] = fits ? static_cast<float>(*value) : std::numeric_limits<float>::quiet_NaN();
    }
    file.points.push_back(pick(*points));
    if (normals) file.normals.push_back(pick(*normals));
  }
  return file;
}

absl::StatusOr<PointFile> Decode(std::string_view bytes) {
  absl::StatusOr<PlyHeader> header = ParsePlyHeader(bytes);
  if (!header.ok()) return header.status();
  Body body(bytes.substr(header->body_offset), header->encoding);
  absl::StatusOr<PointFile> file = absl::InvalidArgumentError("it has no element named vertex");
  for (const PlyHeader::Element& element : header->elements) {
    if (element.name == "vertex") {
      if (absl::Status vertex = CheckVertex(element); !vertex.ok()) return vertex;
      file = ReadVertices(element, body);
      if (!file.ok()) return file;
      continue;
    }
    if (element.properties.empty()) continue;
    for (std::int64_t i = 0; i < element.count; ++i) {
      if (!Skip(element, body)) {
        return absl::InvalidArgumentError(
            absl::StrCat("in its element ", absl::CHexEscape(element.name), ", ", body.Trouble()));
      }
    }
  }
  return file;
}

}  // namespace

absl::StatusOr<PointFile> ReadPly(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || !in) {
    return absl::PermissionDeniedError(
        absl::StrCat(path.string(), " cannot be opened; make it readable"));
  }
  absl::StatusOr<PointFile> file = absl::InvalidArgumentError("it is larger than 4 GiB");
  if (size < kMaxFileBytes) {
    std::string bytes(static_cast<std::size_t>(size), '\0');
    in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(in.gcount()));
    file = Decode(bytes);
  }
  if (file.ok()) return file;
  return absl::InvalidArgumentError(absl::StrCat(path.string(),
                                                 " cannot be read: ", file.status().message(),
                                                 "; write it again as a PLY file"));
}

}  // namespace graspdb::client
