#include "files/points/pcd_points.h"

#include <lzf.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"

namespace graspdb::files {
namespace {

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
