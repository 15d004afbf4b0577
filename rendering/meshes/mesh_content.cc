#include "rendering/meshes/mesh_content.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "base/status_macros.h"
#include "files/points/ply_file.h"
#include "files/points/ply_header.h"
#include "program/text/text_encoding.h"
#include "rendering/meshes/length_unit.h"
#include "rendering/meshes/plain_obj.h"
#include "rendering/meshes/stl_facets.h"

namespace graspdb::rendering {
namespace {

enum class UnitText { kComment, kName };

// Of a line; longer ones are data.
constexpr std::size_t kMaxCharacters = 200;

struct Word {
  std::string text;
  bool is_value = false;  // behind ":" or "="
};

// Of letters, digits and points, in lower case; other characters separate words.
std::vector<Word> WordsOf(std::string_view line) {
  std::vector<Word> words(1);
  for (const char c : line) {
    const auto byte = static_cast<unsigned char>(c);
    if (absl::ascii_isalnum(byte) || c == '.') {
      words.back().text += absl::ascii_tolower(byte);
      continue;
    }
    if (!words.back().text.empty()) words.emplace_back();
    words.back().is_value = words.back().is_value || c == ':' || c == '=';
  }
  for (Word& word : words) {
    while (word.text.ends_with('.')) word.text.pop_back();  // the end of a sentence
  }
  if (words.back().text.empty()) words.pop_back();
  return words;
}

std::optional<double> UnitNamed(const std::string& word) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 16> kOtherNames = {
      {{"millimeter", "mm"},
       {"millimeters", "mm"},
       {"millimetre", "mm"},
       {"millimetres", "mm"},
       {"centimeter", "cm"},
       {"centimeters", "cm"},
       {"centimetre", "cm"},
       {"centimetres", "cm"},
       {"meter", "m"},
       {"meters", "m"},
       {"metre", "m"},
       {"metres", "m"},
       {"in", "inch"},
       {"inches", "inch"},
       {"mms", "mm"},
       {"cms", "cm"}}};
  const auto* other = std::ranges::find(kOtherNames, std::string_view(word),
                                        &std::pair<std::string_view, std::string_view>::first);
  const std::string_view name = other == kOtherNames.end() ? std::string_view(word) : other->second;
  const auto* unit = std::ranges::find(kLengthUnits, name, &LengthUnit::name);
  return unit == kLengthUnits.end() ? std::nullopt : std::optional(unit->metres);
}

// Words between "unit" and its length.
bool IsBetween(const std::string& word) {
  constexpr std::array<std::string_view, 7> kBetween = {"is",     "are",     "of",         "the",
                                                        "length", "measure", "measurement"};
  return std::ranges::find(kBetween, std::string_view(word)) != kBetween.end();
}

// Whether the length of a unit stands behind the word at `i`.
bool IsUnitAt(const std::vector<Word>& words, std::size_t i, UnitText text) {
  if (words[i].text == "units") return true;
  return words[i].text == "unit" && (text == UnitText::kComment || words[i + 1].is_value);
}

// The length of the unit after the word "unit" or "units" in `line`, in metres: of "# File units =
// millimeters", "UNITS=mm", or "1 unit = 1000.0 mm"; empty without one, and behind its first
// 200 characters. No format has a field for it. Names of parts
// may have the word "unit" too, as "power-unit-in-housing": there ":" or "=" must follow it.
std::optional<double> StatedUnit(std::string_view line, UnitText text) {
  if (line.size() > kMaxCharacters) {
    line = line.substr(0, kMaxCharacters);
    line = line.substr(0, line.find_last_of(' '));  // no part of a word
  }
  const std::vector<Word> words = WordsOf(line);
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (!IsUnitAt(words, i, text)) continue;
    std::size_t at = i + 1;
    while (at + 1 < words.size() && IsBetween(words[at].text)) ++at;
    // "units in mm", but "unit: in".
    if (at + 1 < words.size() && words[at].text == "in" && UnitNamed(words[at + 1].text)) ++at;
    double count = 0;
    if (at + 1 < words.size() && absl::SimpleAtod(words[at].text, &count)) {
      ++at;
    } else {
      count = 1;
    }
    // Else the word: "units in use".
    const bool is_in = words[at].text == "in";
    if (is_in && at + 1 < words.size() && !words[at].is_value) continue;
    const std::optional<double> unit_m = UnitNamed(words[at].text);
    if (unit_m && count > 0 && std::isfinite(count)) return count * *unit_m;
  }
  return std::nullopt;
}

constexpr std::uintmax_t kMaxMeshBytes = std::uintmax_t{2} << 30;

using Named = std::pair<std::string_view, std::string_view>;

// INVALID_ARGUMENT for another ending than those of the formats that are read.
absl::Status CheckFormat(const std::string& ending) {
  constexpr std::array<Named, 12> kOthers = {{{".dae", "a Collada file"},
                                              {".3mf", "a 3MF file"},
                                              {".gltf", "a glTF file"},
                                              {".glb", "a glTF file"},
                                              {".fbx", "an FBX file"},
                                              {".3ds", "a 3D Studio file"},
                                              {".x3d", "an X3D file"},
                                              {".wrl", "a VRML file"},
                                              {".off", "an OFF file"},
                                              {".amf", "an AMF file"},
                                              {".step", "a STEP file, which has no triangles"},
                                              {".stp", "a STEP file, which has no triangles"}}};
  if (ending == ".ply" || ending == ".obj" || ending == ".stl") return absl::OkStatus();
  const auto* other = std::ranges::find(kOthers, std::string_view(ending), &Named::first);
  return absl::InvalidArgumentError(
      absl::StrCat("it is ",
                   other == kOthers.end() ? absl::StrCat("a file with the ending \"", ending, "\"")
                                          : std::string(other->second),
                   ", whose units and axes are not read; export it as PLY, OBJ or STL"));
}

absl::StatusOr<std::string> BytesIn(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || !in) return absl::InvalidArgumentError("it cannot be opened; make it readable");
  if (size > kMaxMeshBytes) return absl::InvalidArgumentError("it is larger than 2 GiB");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  return bytes;
}

// The first of `lines` that begins with one of `starts` and states a unit.
void TakeUnit(absl::string_view lines, std::initializer_list<absl::string_view> starts,
              UnitText text, MeshContent& content) {
  for (absl::string_view line : absl::StrSplit(lines, '\n')) {
    line = absl::StripAsciiWhitespace(line);
    const auto is_start = [&](absl::string_view start) { return absl::StartsWith(line, start); };
    if (std::ranges::none_of(starts, is_start)) continue;
    content.unit_m = StatedUnit({line.data(), line.size()}, text);
    if (!content.unit_m) continue;
    content.unit_line = std::string(line);
    return;
  }
}

bool IsListOfCorners(const files::PlyHeader::Property& property) {
  const bool is_real = property.type == files::PlyHeader::Type::kFloat32 ||
                       property.type == files::PlyHeader::Type::kFloat64;
  return property.is_list && !is_real &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

absl::Status CheckElements(const files::PlyHeader& header) {
  const auto face = std::ranges::find(header.elements, "face", &files::PlyHeader::Element::name);
  if (std::ranges::find(header.elements, "tristrips", &files::PlyHeader::Element::name) !=
      header.elements.end()) {
    return absl::InvalidArgumentError(
        "triangle strips (its element tristrips) are not supported; export it with triangles");
  }
  if (face == header.elements.end()) {
    return absl::InvalidArgumentError("it has no element named face, as of a cloud");
  }
  if (std::ranges::any_of(face->properties, IsListOfCorners)) return absl::OkStatus();
  return absl::InvalidArgumentError("its faces have no list named vertex_indices or vertex_index");
}

// assimp takes each line of text for a row.
absl::Status CheckLines(const files::PlyHeader& header, absl::string_view body) {
  std::int64_t rows = 0;
  for (const files::PlyHeader::Element& element : header.elements) {
    if (!element.properties.empty()) rows += element.count;
  }
  std::int64_t lines = 0;
  for (const absl::string_view line : absl::StrSplit(body, '\n')) {
    lines += absl::StripAsciiWhitespace(line).empty() ? 0 : 1;
  }
  if (lines == rows) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("its ", rows, " rows go over ", lines,
                   " lines, as RealSense's do; export it with one line for each, or in binary"));
}

// assimp never returns from some damaged PLY files, so our own reader reads them first. It also
// drops a binary body's first byte where it looks like one more line end of the header
// (github.com/assimp/assimp/issues/5341), and misreads all that follows: an element of one letter
// comes before all others. It is named 1, since assimp reads the count of an unknown element at
// the position of its name.
absl::Status PreparePly(const std::filesystem::path& path, MeshContent& content) {
  if (const auto points = files::ReadPly(path); !points.ok()) {
    return absl::InvalidArgumentError(absl::StripPrefix(
        points.status().message(), absl::StrCat(path.string(), " cannot be read: ")));
  }
  RETURN_IF_ERROR(TakeUtf8("it", &content.bytes));
  ASSIGN_OR_RETURN(const files::PlyHeader header, files::ParsePlyHeader(content.bytes));
  RETURN_IF_ERROR(CheckElements(header));
  TakeUnit(absl::string_view(content.bytes).substr(0, header.body_offset), {"comment", "obj_info"},
           UnitText::kComment, content);
  if (header.encoding == files::PlyHeader::Encoding::kAscii) {
    return CheckLines(header, absl::string_view(content.bytes).substr(header.body_offset));
  }
  if (header.elements_offset == 0) return absl::OkStatus();
  content.bytes.insert(header.body_offset, 1, 'x');
  content.bytes.insert(header.elements_offset, "element 1 1\nproperty uchar pad\n");
  return absl::OkStatus();
}

absl::Status PrepareObjOrStl(MeshContent& content) {
  const bool is_obj = content.format == "obj";
  const bool is_text = is_obj || !IsBinaryStl(content.bytes);
  RETURN_IF_ERROR(is_text ? TakeUtf8("it", &content.bytes) : absl::OkStatus());
  if (is_obj) {
    TakeUnit(content.bytes, {"#"}, UnitText::kComment, content);
  } else {
    TakeUnit(StlDescription(content.bytes), {""}, UnitText::kName, content);
  }
  ASSIGN_OR_RETURN(content.bytes, is_obj ? PlainObj(content.bytes) : BinaryStl(content.bytes));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<MeshContent> ReadMeshContent(const std::filesystem::path& path) {
  const std::string ending = absl::AsciiStrToLower(path.extension().string());
  RETURN_IF_ERROR(CheckFormat(ending));
  ASSIGN_OR_RETURN(std::string bytes, BytesIn(path));
  MeshContent content{
      .bytes = std::move(bytes), .format = ending.substr(1), .unit_m = {}, .unit_line = {}};
  RETURN_IF_ERROR(content.format == "ply" ? PreparePly(path, content) : PrepareObjOrStl(content));
  return content;
}

}  // namespace graspdb::rendering
