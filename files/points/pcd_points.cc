#include "files/points/pcd_points.h"

#include <lzf.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <system_error>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "files/points/surplus_bytes.h"

namespace graspdb::files {
namespace {

static_assert(std::endian::native == std::endian::little, "PCD bodies are little-endian");

// Three bytes of LZF expand to at most 264; larger declared sizes are rejected before allocation.
constexpr std::int64_t kMaxUnpacked = 264 / 3;

absl::Status Damaged(const std::filesystem::path& path, const std::string& what) {
  return absl::InvalidArgumentError(
      absl::StrCat(path.string(), " is damaged: ", what, "; copy or capture the cloud again"));
}

// "inf" and numbers beyond single precision are rejected, as PCL would read a zero.
bool IsNumber(absl::string_view word) {
  double value = 0;
  if (!absl::SimpleAtod(word, &value)) return false;
  return std::isnan(value) || std::abs(value) <= std::numeric_limits<float>::max();
}

absl::Status CheckAscii(const std::filesystem::path& path, const PcdHeader& header,
                        std::ifstream& in) {
  const auto expected = static_cast<std::size_t>(header.numbers_per_point());
  std::int64_t rows = 0;
  std::string line;
  while (std::getline(in, line)) {
    const std::vector<absl::string_view> words =
        absl::StrSplit(line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
    if (words.empty()) continue;
    ++rows;
    if (words.size() != expected) {
      return Damaged(path, absl::StrCat("row ", rows, " of its points has ", words.size(),
                                        " numbers instead of ", expected));
    }
    const auto bad = std::find_if_not(words.begin(), words.end(), IsNumber);
    if (bad != words.end()) {
      return Damaged(path, absl::StrCat("row ", rows, " of its points has \"",
                                        absl::CHexEscape(bad->substr(0, 20)),
                                        "\" where a finite number or nan belongs"));
    }
  }
  if (rows == header.point_count()) return absl::OkStatus();
  return Damaged(path, absl::StrCat("it has ", rows, " points, and its header promises ",
                                    header.point_count()));
}

absl::Status CheckSurplus(const std::filesystem::path& path, const PcdHeader& header,
                          std::int64_t promised) {
  const std::string error =
      SurplusError(path, header.body_offset, static_cast<std::uint64_t>(promised));
  return error.empty() ? absl::OkStatus() : Damaged(path, error);
}

absl::Status CheckBinary(const std::filesystem::path& path, const PcdHeader& header,
                         std::int64_t body_bytes) {
  const std::int64_t promised = header.point_count() * header.point_bytes();
  if (body_bytes == promised) return absl::OkStatus();
  if (body_bytes > promised) return CheckSurplus(path, header, promised);
  return Damaged(path, absl::StrCat("it has ", body_bytes, " bytes of points, and its header ",
                                    "promises ", promised));
}

absl::Status CheckCompressed(const std::filesystem::path& path, const PcdHeader& header,
                             std::int64_t body_bytes, std::ifstream& in) {
  const auto is_padding = [](const PcdHeader::Field& field) { return field.name == "_"; };
  if (std::any_of(header.fields.begin(), header.fields.end(), is_padding)) {
    return absl::InvalidArgumentError(
        absl::StrCat(path.string(),
                     " has padding fields and a compressed body, which programs read differently; ",
                     "write it again as DATA binary"));
  }
  std::uint32_t sizes[2] = {0, 0};  // compressed, uncompressed
  if (!in.read(reinterpret_cast<char*>(sizes), sizeof(sizes))) {
    return Damaged(path, "its compressed body ends before its sizes");
  }
  const std::int64_t promised = header.point_count() * header.point_bytes();
  if (sizes[1] != promised) {
    return Damaged(path, absl::StrCat("its body unpacks to ", sizes[1],
                                      " bytes, and its header promises ", promised));
  }
  const std::int64_t there = body_bytes - std::int64_t{sizeof(sizes)};
  if (sizes[0] == 0 || sizes[0] > there) {
    return Damaged(
        path, absl::StrCat("its body declares ", sizes[0], " compressed bytes, and has ", there));
  }
  if (promised > std::int64_t{sizes[0]} * kMaxUnpacked) {
    return Damaged(path, absl::StrCat("its ", sizes[0], " compressed bytes cannot hold the ",
                                      promised, " bytes that its header promises"));
  }
  if (sizes[0] == there) return absl::OkStatus();
  return CheckSurplus(path, header, std::int64_t{sizeof(sizes)} + sizes[0]);
}

// A field that is one floating-point number.
struct Column {
  std::size_t word = 0;   // of an ascii row
  std::size_t first = 0;  // offset of the first point's number, bytes
  std::size_t step = 0;   // stride between points, bytes
  bool is_double = false;

  float At(const std::string& body, std::size_t point) const {
    const char* from = body.data() + first + point * step;
    if (is_double) {
      double value = 0;
      std::memcpy(&value, from, sizeof(value));
      return static_cast<float>(value);
    }
    float value = 0;
    std::memcpy(&value, from, sizeof(value));
    return value;
  }
};

using Columns = std::array<Column, 3>;

std::optional<Column> FindColumn(const PcdHeader& header, const std::string& name) {
  const bool is_compressed = header.encoding == PcdHeader::Encoding::kBinaryCompressed;
  const auto points = static_cast<std::size_t>(header.point_count());
  Column column;
  for (const PcdHeader::Field& field : header.fields) {
    const auto bytes = static_cast<std::size_t>(field.size) * static_cast<std::size_t>(field.count);
    if (field.name == name && field.type == 'F' && field.count == 1 && field.size >= 4) {
      // Compressed bodies have all numbers of one field, then all of the next.
      column.step = is_compressed ? bytes : static_cast<std::size_t>(header.point_bytes());
      column.is_double = field.size == 8;
      return column;
    }
    column.word += static_cast<std::size_t>(field.count);
    column.first += is_compressed ? bytes * points : bytes;
  }
  return std::nullopt;
}

std::optional<Columns> FindColumns(const PcdHeader& header,
                                   const std::array<const char*, 3>& names) {
  Columns columns;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::optional<Column> column = FindColumn(header, names[i]);
    if (!column) return std::nullopt;
    columns[i] = *column;
  }
  return columns;
}

std::vector<Eigen::Vector3f> Extract(const std::string& body, const Columns& columns,
                                     std::size_t count) {
  std::vector<Eigen::Vector3f> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    values[i] = {columns[0].At(body, i), columns[1].At(body, i), columns[2].At(body, i)};
  }
  return values;
}

using Views = std::vector<absl::string_view>;

Eigen::Vector3f Extract(const Views& words, const Columns& columns) {
  Eigen::Vector3f value;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Column& column = columns[static_cast<std::size_t>(axis)];
    if (!absl::SimpleAtof(words[column.word], &value[axis])) {
      value[axis] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  return value;
}

void DecodeAscii(std::ifstream& in, const Columns& points, const std::optional<Columns>& normals,
                 PointFile& file) {
  std::string line;
  while (std::getline(in, line)) {
    const Views words = absl::StrSplit(line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
    if (words.empty()) continue;
    file.points.push_back(Extract(words, points));
    if (normals) file.normals.push_back(Extract(words, *normals));
  }
}

std::string ReadBytes(std::ifstream& in, std::size_t count) {
  std::string bytes(count, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(count));
  return in ? bytes : "";
}

// Empty when it cannot be read or unpacked.
std::string ReadBody(std::ifstream& in, const PcdHeader& header) {
  const auto promised = static_cast<std::size_t>(header.point_count() * header.point_bytes());
  if (header.encoding == PcdHeader::Encoding::kBinary) return ReadBytes(in, promised);
  std::uint32_t sizes[2] = {0, 0};  // compressed, uncompressed
  if (!in.read(reinterpret_cast<char*>(sizes), sizeof(sizes))) return "";
  const std::string packed = ReadBytes(in, sizes[0]);
  if (packed.empty() || sizes[1] != promised) return "";
  std::string body(promised, '\0');
  const unsigned unpacked = lzf_decompress(packed.data(), sizes[0], body.data(), sizes[1]);
  return unpacked == sizes[1] ? body : "";
}

constexpr char kPointFields[] = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
constexpr char kOrientedFields[] =
    "FIELDS x y z normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F\n"
    "COUNT 1 1 1 1 1 1\n";

std::string HeaderOf(const PointFile& file) {
  const recognition::Pose pose = file.sensor_pose.value_or(recognition::Pose::Identity());
  const Eigen::Vector3f t = pose.translation().cast<float>();
  const Eigen::Quaternionf q = Eigen::Quaterniond(pose.linear()).cast<float>();
  return absl::StrFormat(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n%sWIDTH %d\nHEIGHT %d\n"
      "VIEWPOINT %.9g %.9g %.9g %.9g %.9g %.9g %.9g\nPOINTS %d\nDATA binary_compressed\n",
      file.normals.empty() ? kPointFields : kOrientedFields, file.width, file.height, t.x(), t.y(),
      t.z(), q.w(), q.x(), q.y(), q.z(), file.points.size());
}

// All x, then all y, then all z.
void AppendColumns(const std::vector<Eigen::Vector3f>& values, std::string* body) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (const Eigen::Vector3f& value : values) {
      body->append(reinterpret_cast<const char*>(&value[axis]), sizeof(float));
    }
  }
}

}  // namespace

absl::Status CheckPcdBody(const std::filesystem::path& path, const PcdHeader& header) {
  std::error_code error;
  const auto file_bytes = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  std::ifstream in(path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(header.body_offset));
  if (error || !in) return Damaged(path, "its body cannot be reached");
  const std::int64_t body_bytes = file_bytes - static_cast<std::int64_t>(header.body_offset);
  switch (header.encoding) {
    case PcdHeader::Encoding::kAscii:
      return CheckAscii(path, header, in);
    case PcdHeader::Encoding::kBinary:
      return CheckBinary(path, header, body_bytes);
    case PcdHeader::Encoding::kBinaryCompressed:
      return CheckCompressed(path, header, body_bytes, in);
  }
  return Damaged(path, "its encoding is unknown");
}

std::string EncodePcd(const PointFile& file) {
  std::string body;
  body.reserve((file.points.size() + file.normals.size()) * sizeof(Eigen::Vector3f));
  AppendColumns(file.points, &body);
  AppendColumns(file.normals, &body);
  // LZF adds a byte to 32 that it cannot compress.
  std::string packed(body.size() + body.size() / 32 + 16, '\0');
  const std::uint32_t sizes[2] = {lzf_compress(body.data(), static_cast<unsigned>(body.size()),
                                               packed.data(), static_cast<unsigned>(packed.size())),
                                  static_cast<std::uint32_t>(body.size())};
  return absl::StrCat(HeaderOf(file),
                      absl::string_view(reinterpret_cast<const char*>(sizes), sizeof(sizes)),
                      absl::string_view(packed).substr(0, sizes[0]));
}

absl::StatusOr<PointFile> DecodePcd(const std::filesystem::path& path, const PcdHeader& header) {
  const auto damaged = [&path] {
    return absl::InvalidArgumentError(absl::StrCat(
        path.string(),
        " is damaged: its points cannot be unpacked; copy or capture the cloud again"));
  };
  std::ifstream in(path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(header.body_offset));
  const std::optional<Columns> points = FindColumns(header, {"x", "y", "z"});
  const std::optional<Columns> normals = FindColumns(header, {"normal_x", "normal_y", "normal_z"});
  if (!in || !points) return damaged();
  PointFile file;
  file.width = header.width;
  file.height = header.height;
  const auto count = static_cast<std::size_t>(header.point_count());
  if (header.encoding == PcdHeader::Encoding::kAscii) {
    DecodeAscii(in, *points, normals, file);
    if (file.points.size() != count) return damaged();
    return file;
  }
  const std::string body = ReadBody(in, header);
  if (body.empty()) return damaged();
  file.points = Extract(body, *points, count);
  if (normals) file.normals = Extract(body, *normals, count);
  return file;
}

}  // namespace graspdb::files
