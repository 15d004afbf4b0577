#include "files/points/pcd_header.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <set>

#include "absl/status/status.h"
#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "base/status_macros.h"
#include "files/points/point_file.h"
#include "program/text/text_encoding.h"

namespace graspdb::files {
namespace {

using Words = std::vector<std::string>;

constexpr int kMaxHeaderLines = 1000;
constexpr std::size_t kMaxPcdLineBytes = std::size_t{64} * 1024;
constexpr int kMaxFieldCount = 1024;
constexpr std::int64_t kMaxBodyBytes = std::int64_t{4} << 30;
constexpr double kViewpointTolerance = 1e-3;

// One line of the header; empty at the end of the file or when no line feed
// comes within kMaxPcdLineBytes, as in a file that is not text.
std::optional<std::string> NextLine(std::istream& in) {
  std::string line;
  for (char c = 0; line.size() < kMaxPcdLineBytes && in.get(c);) {
    if (c == '\n') return line;
    line.push_back(c);
  }
  return std::nullopt;
}

absl::Status ExpectCount(const Words& values, const PcdHeader& header, const char* key) {
  if (!header.fields.empty() && values.size() == header.fields.size()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("its ", key, " line has ", values.size(),
                                                 " entries for ", header.fields.size(), " fields"));
}

absl::Status ParseFields(const Words& values, PcdHeader& header) {
  header.fields.clear();
  for (const std::string& name : values) header.fields.push_back({.name = name});
  return values.empty() ? absl::InvalidArgumentError("its FIELDS line names no field")
                        : absl::OkStatus();
}

absl::Status ParseSizes(const Words& values, PcdHeader& header) {
  RETURN_IF_ERROR(ExpectCount(values, header, "SIZE"));
  for (std::size_t i = 0; i < values.size(); ++i) {
    int size = 0;
    if (!absl::SimpleAtoi(values[i], &size) || !std::set{1, 2, 4, 8}.contains(size)) {
      return absl::InvalidArgumentError(
          absl::StrCat("its SIZE line has \"", values[i], "\" where 1, 2, 4 or 8 belongs"));
    }
    header.fields[i].size = size;
  }
  return absl::OkStatus();
}

absl::Status ParseTypes(const Words& values, PcdHeader& header) {
  RETURN_IF_ERROR(ExpectCount(values, header, "TYPE"));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] != "F" && values[i] != "I" && values[i] != "U") {
      return absl::InvalidArgumentError(
          absl::StrCat("its TYPE line has \"", values[i], "\" where F, I or U belongs"));
    }
    header.fields[i].type = values[i].front();
  }
  return absl::OkStatus();
}

absl::Status ParseCounts(const Words& values, PcdHeader& header) {
  RETURN_IF_ERROR(ExpectCount(values, header, "COUNT"));
  for (std::size_t i = 0; i < values.size(); ++i) {
    int count = 0;
    const int fewest = header.fields[i].name == "_" ? 0 : 1;  // of padding
    if (!absl::SimpleAtoi(values[i], &count) || count < fewest || count > kMaxFieldCount) {
      return absl::InvalidArgumentError(absl::StrCat("its COUNT line has \"", values[i],
                                                     "\" where 1 to ", kMaxFieldCount, " belongs"));
    }
    header.fields[i].count = count;
  }
  return absl::OkStatus();
}

absl::Status ParsePointNumber(const Words& values, const char* key, int& number) {
  std::int64_t value = 0;
  if (values.size() != 1 || !absl::SimpleAtoi(values[0], &value) || value < 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("its ", key, " line does not give one whole number"));
  }
  if (value > kMaxPoints) {
    return absl::InvalidArgumentError(absl::StrCat("its ", key, " line promises ", value,
                                                   " points; at most ", kMaxPoints, " are read"));
  }
  number = static_cast<int>(value);
  return absl::OkStatus();
}

absl::Status ParseViewpoint(const Words& values, PcdHeader& header) {
  std::array<double, 7> v{};
  bool good = values.size() == v.size();
  for (std::size_t i = 0; good && i < v.size(); ++i) {
    good = absl::SimpleAtod(values[i], &v[i]) &&
           std::abs(v[i]) <= static_cast<double>(std::numeric_limits<float>::max());
  }
  if (!good)
    return absl::InvalidArgumentError(
        "its VIEWPOINT line does not give seven numbers, tx ty tz qw qx qy qz");
  const Eigen::Quaterniond q(v[3], v[4], v[5], v[6]);
  if (std::abs(q.norm() - 1) > kViewpointTolerance) {
    return absl::InvalidArgumentError(
        absl::StrCat("the quaternion of its VIEWPOINT line has the norm ", q.norm(),
                     " instead of 1 (unknown is written 0 0 0 1 0 0 0)"));
  }
  recognition::Pose pose = recognition::Pose::Identity();
  pose.linear() = q.normalized().toRotationMatrix();
  pose.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  if (!pose.matrix().isIdentity(1e-9)) header.sensor_pose = pose;
  return absl::OkStatus();
}

absl::Status ParseEncoding(const Words& values, PcdHeader& header) {
  static const std::map<std::string, PcdHeader::Encoding> encodings = {
      {"ascii", PcdHeader::Encoding::kAscii},
      {"binary", PcdHeader::Encoding::kBinary},
      {"binary_compressed", PcdHeader::Encoding::kBinaryCompressed}};
  const auto found = values.size() == 1 ? encodings.find(values[0]) : encodings.end();
  if (found == encodings.end()) {
    return absl::InvalidArgumentError(
        "its DATA line is neither ascii nor binary nor binary_compressed");
  }
  header.encoding = found->second;
  return absl::OkStatus();
}

// The content of the lines up to DATA.
struct Lines {
  PcdHeader header;
  int points = 0;
  std::set<std::string> seen;
};

absl::Status ParseLine(const Words& words, int number, Lines& lines) {
  const Words values(words.begin() + 1, words.end());
  PcdHeader& header = lines.header;
  const std::string key = words[0] == "COLUMNS" ? "FIELDS" : words[0];
  const std::map<std::string, std::function<absl::Status()>> parsers = {
      {"VERSION", [] { return absl::OkStatus(); }},
      {"FIELDS", [&] { return ParseFields(values, header); }},
      {"SIZE", [&] { return ParseSizes(values, header); }},
      {"TYPE", [&] { return ParseTypes(values, header); }},
      {"COUNT", [&] { return ParseCounts(values, header); }},
      {"WIDTH", [&] { return ParsePointNumber(values, "WIDTH", header.width); }},
      {"HEIGHT", [&] { return ParsePointNumber(values, "HEIGHT", header.height); }},
      {"POINTS", [&] { return ParsePointNumber(values, "POINTS", lines.points); }},
      {"VIEWPOINT", [&] { return ParseViewpoint(values, header); }},
      {"DATA", [&] { return ParseEncoding(values, header); }}};
  const auto parser = parsers.find(key);
  if (parser == parsers.end()) {
    return absl::InvalidArgumentError(absl::StrCat("it is not a PCD file, as line ", number,
                                                   " begins with \"",
                                                   absl::CHexEscape(key.substr(0, 20)), "\""));
  }
  if (!lines.seen.insert(key).second)
    return absl::InvalidArgumentError(absl::StrCat("it has two ", key, " lines"));
  return parser->second();
}

absl::Status CheckComplete(const Lines& lines) {
  for (const char* key : {"FIELDS", "SIZE", "TYPE", "WIDTH", "HEIGHT", "POINTS"}) {
    if (!lines.seen.contains(key))
      return absl::InvalidArgumentError(absl::StrCat("its header has no ", key, " line"));
  }
  const PcdHeader& header = lines.header;
  for (const char* axis : {"x", "y", "z"}) {
    int found = 0;
    for (const PcdHeader::Field& field : header.fields) {
      if (field.name != axis) continue;
      ++found;
      if (field.type != 'F' || field.size < 4 || field.count != 1) {
        return absl::InvalidArgumentError(
            absl::StrCat("its field ", axis, " is not one float or double"));
      }
    }
    if (found != 1)
      return absl::InvalidArgumentError(
          absl::StrCat("it has ", found, " fields named ", axis, ", not one"));
  }
  if (header.point_count() != lines.points) {
    return absl::InvalidArgumentError(absl::StrCat("its header has POINTS ", lines.points,
                                                   ", but WIDTH ", header.width, " and HEIGHT ",
                                                   header.height));
  }
  if (lines.points == 0) return absl::InvalidArgumentError("its header promises no points");
  if (header.point_count() * header.point_bytes() >= kMaxBodyBytes) {
    return absl::InvalidArgumentError("its header promises more than 4 GiB of points");
  }
  return absl::OkStatus();
}

absl::StatusOr<PcdHeader> Parse(std::istream& in) {
  Lines lines;
  for (int number = 1; number <= kMaxHeaderLines; ++number) {
    std::optional<std::string> line = NextLine(in);
    if (!line) break;
    RETURN_IF_ERROR(number == 1 ? TakeUtf8("its header", &*line) : absl::OkStatus());
    const Words words = absl::StrSplit(*line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
    if (words.empty() || words[0][0] == '#') continue;
    RETURN_IF_ERROR(ParseLine(words, number, lines));
    if (words[0] != "DATA") continue;
    RETURN_IF_ERROR(CheckComplete(lines));
    lines.header.body_offset = static_cast<std::size_t>(in.tellg());
    return lines.header;
  }
  return absl::InvalidArgumentError("its header has no DATA line: it is cut, or no PCD file");
}

}  // namespace

std::int64_t PcdHeader::point_bytes() const {
  std::int64_t bytes = 0;
  for (const Field& field : fields) bytes += std::int64_t{field.size} * field.count;
  return bytes;
}

int PcdHeader::numbers_per_point() const {
  int numbers = 0;
  for (const Field& field : fields) numbers += field.count;
  return numbers;
}

absl::StatusOr<PcdHeader> ReadPcdHeader(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    return absl::PermissionDeniedError(
        absl::StrCat(path.string(), " cannot be opened; make it readable"));
  }
  absl::StatusOr<PcdHeader> header = Parse(in);
  if (header.ok()) return header;
  return absl::InvalidArgumentError(absl::StrCat(path.string(),
                                                 " cannot be read: ", header.status().message(),
                                                 "; write the cloud again as a PCD file"));
}

}  // namespace graspdb::files
