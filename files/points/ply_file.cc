#include "files/points/ply_file.h"

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
#include "base/status_macros.h"
#include "files/points/ply_header.h"
#include "files/points/surplus_bytes.h"

namespace graspdb::files {
namespace {

using Type = PlyHeader::Type;

constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{4} << 30;
constexpr double kMaxListLength = 4294967295;  // of a uint
static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kSpaces = " \t\r";
constexpr std::string_view kSpacesAndLineFeeds = " \t\r\n";

// Reads the numbers of a body one by one, in any encoding.
class Body {
 public:
  Body(std::string_view bytes, PlyHeader::Encoding encoding)
      : bytes_(bytes), encoding_(encoding), total_(bytes.size()) {}

  // Of ascii, an instance of an element ends with a line, and may go over several, as RealSense's
  // do (github.com/IntelRealSense/librealsense/issues/9803): numbers that the header does not
  // declare, or that are missing, would shift all that follow.
  void BeginRow() {
    if (is_ascii()) SkipAll(kSpacesAndLineFeeds);
  }

  bool EndRow() {
    if (!is_ascii()) return true;
    SkipAll(kSpaces);
    if (bytes_.empty() || bytes_.front() == '\n') return true;
    trouble_ = "its row has more or fewer numbers than the header declares";
    return false;
  }

  // Empty when the body or the row ends first or a word is not a number.
  std::optional<double> Next(Type type) { return is_ascii() ? NextWord() : NextBinary(type); }

  // The number of entries of a list.
  std::optional<std::int64_t> NextLength(Type type) {
    const std::optional<double> length = Next(type);
    if (!length) return std::nullopt;
    if (*length >= 0 && *length <= kMaxListLength && *length == std::floor(*length)) {
      return static_cast<std::int64_t>(*length);
    }
    trouble_ = absl::StrCat("a list has the length ", *length);
    return std::nullopt;
  }

  // The reason why the last call failed.
  std::string Trouble() const {
    if (!trouble_.empty()) return trouble_;
    return absl::StrCat("its body ends after ", total_, " bytes, before all declared elements");
  }

  // Bytes that were read.
  std::size_t position() const { return total_ - bytes_.size(); }

 private:
  bool is_ascii() const { return encoding_ == PlyHeader::Encoding::kAscii; }

  void SkipAll(std::string_view characters) {
    bytes_.remove_prefix(std::min(bytes_.find_first_not_of(characters), bytes_.size()));
  }

  std::optional<double> NextWord() {
    SkipAll(kSpacesAndLineFeeds);
    if (bytes_.empty()) return std::nullopt;
    const std::string_view word = bytes_.substr(0, bytes_.find_first_of(kSpacesAndLineFeeds));
    bytes_.remove_prefix(word.size());
    double value = 0;
    if (absl::SimpleAtod(absl::string_view(word.data(), word.size()), &value)) return value;
    trouble_ = absl::StrCat(
        "\"",
        absl::CHexEscape(absl::string_view(word.data(), std::min<std::size_t>(word.size(), 20))),
        "\" stands where a number belongs");
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
  std::string trouble_;
};

// Skips one instance of an element; a list is bounded by the body.
bool Skip(const PlyHeader::Element& element, Body& body) {
  body.BeginRow();
  for (const PlyHeader::Property& property : element.properties) {
    std::int64_t values = 1;
    if (property.is_list) {
      const std::optional<std::int64_t> length = body.NextLength(property.length_type);
      if (!length) return false;
      values = *length;
    }
    for (std::int64_t i = 0; i < values; ++i) {
      if (!body.Next(property.type)) return false;
    }
  }
  return body.EndRow();
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
    const auto bad_row = [&] {
      return absl::InvalidArgumentError(absl::StrCat("at point ", i + 1, ", ", body.Trouble()));
    };
    body.BeginRow();
    for (std::size_t k = 0; k < row.size(); ++k) {
      const std::optional<double> value = body.Next(vertex.properties[k].type);
      if (!value) return bad_row();
      // Values beyond single precision count as no measurement.
      const bool fits = std::abs(*value) <= std::numeric_limits<float>::max();
      row[k] = fits ? static_cast<float>(*value) : std::numeric_limits<float>::quiet_NaN();
    }
    if (!body.EndRow()) return bad_row();
    file.points.push_back(pick(*points));
    if (normals) file.normals.push_back(pick(*normals));
  }
  return file;
}

// Whether anything follows the last declared element.
absl::Status CheckEnd(const std::filesystem::path& path, std::string_view bytes,
                      const PlyHeader& header, std::size_t body_bytes) {
  const std::string_view rest = bytes.substr(header.body_offset + body_bytes);
  if (header.encoding != PlyHeader::Encoding::kAscii) {
    if (rest.empty()) return absl::OkStatus();
    const std::string error = SurplusError(path, header.body_offset, body_bytes);
    return error.empty() ? absl::OkStatus() : absl::InvalidArgumentError(error);
  }
  const std::size_t at = rest.find_first_not_of(kSpacesAndLineFeeds);
  if (at == std::string_view::npos) return absl::OkStatus();
  const std::string_view before = bytes.substr(0, bytes.size() - rest.size() + at);
  return absl::InvalidArgumentError(
      absl::StrCat("line ", std::ranges::count(before, '\n') + 1,
                   " has a row beyond the elements that its header declares"));
}

absl::StatusOr<PointFile> Decode(const std::filesystem::path& path, std::string_view bytes) {
  ASSIGN_OR_RETURN(PlyHeader header, ParsePlyHeader(bytes));
  Body body(bytes.substr(header.body_offset), header.encoding);
  absl::StatusOr<PointFile> file = absl::InvalidArgumentError("it has no element named vertex");
  for (const PlyHeader::Element& element : header.elements) {
    if (element.name == "vertex") {
      if (file.ok()) return absl::InvalidArgumentError("it has two elements named vertex");
      RETURN_IF_ERROR(CheckVertex(element));
      file = ReadVertices(element, body);
      if (!file.ok()) return file;
      continue;
    }
    if (element.properties.empty()) continue;
    for (std::int64_t i = 0; i < element.count; ++i) {
      if (!Skip(element, body)) {
        return absl::InvalidArgumentError(absl::StrCat("in row ", i + 1, " of its element ",
                                                       absl::CHexEscape(element.name), ", ",
                                                       body.Trouble()));
      }
    }
  }
  if (!file.ok()) return file;
  RETURN_IF_ERROR(CheckEnd(path, bytes, header, body.position()));
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
    file = Decode(path, bytes);
  }
  if (file.ok()) return file;
  return absl::InvalidArgumentError(absl::StrCat(path.string(),
                                                 " cannot be read: ", file.status().message(),
                                                 "; write it again as a PLY file"));
}

}  // namespace graspdb::files
