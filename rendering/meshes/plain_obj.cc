#include "rendering/meshes/plain_obj.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "base/status_macros.h"

namespace graspdb::rendering {
namespace {

using Words = std::vector<absl::string_view>;

constexpr std::size_t kMaxVertexWords = 8;  // x y z, weight or colour
constexpr std::size_t kMaxObjLineBytes = 1 << 20;

// Whether a backslash continues a line with that keyword; behind names it is part of the name.
bool IsOfNumbers(absl::string_view keyword) {
  constexpr std::array<absl::string_view, 7> kNumbers = {"v", "vt", "vn", "vp", "f", "l", "p"};
  return std::find(kNumbers.begin(), kNumbers.end(), keyword) != kNumbers.end();
}

bool IsCurved(absl::string_view keyword) {
  return keyword == "surf" || keyword == "cstype" || keyword == "curv" || keyword == "curv2";
}

class ObjReader {
 public:
  explicit ObjReader(absl::string_view text) : text_(text) {}

  absl::StatusOr<std::string> Read() {
    while (!text_.empty()) {
      ASSIGN_OR_RETURN(const std::string line, NextStatement());
      const Words words = absl::StrSplit(line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
      if (words.empty() || words[0].front() == '#') continue;
      RETURN_IF_ERROR(Add(words));
    }
    if (last_corner_ > vertex_count_) {
      return absl::InvalidArgumentError(
          absl::StrCat("line ", last_corner_line_, " has a face with the corner ", last_corner_,
                       ", and there are ", vertex_count_, " vertices"));
    }
    return std::move(out_);
  }

 private:
  // The next line, with those that continue it.
  absl::StatusOr<std::string> NextStatement() {
    absl::string_view line = NextLine();
    const absl::string_view keyword = line.substr(0, line.find_first_of(" \t"));
    std::string out;
    while (out.size() + line.size() <= kMaxObjLineBytes) {
      absl::StrAppend(&out, line);
      if (!IsOfNumbers(keyword) || out.empty() || out.back() != '\\' || text_.empty()) return out;
      out.back() = ' ';
      line = NextLine();
    }
    return Bad("is longer than 1 MiB, with those that it continues");
  }

  absl::string_view NextLine() {
    const std::size_t end = text_.find('\n');
    const absl::string_view line = text_.substr(0, end);
    text_.remove_prefix(end == absl::string_view::npos ? text_.size() : end + 1);
    ++line_;
    return absl::StripAsciiWhitespace(line);
  }

  absl::Status Bad(const std::string& what) const {
    return absl::InvalidArgumentError(absl::StrCat("line ", line_, " ", what));
  }

  absl::Status Add(const Words& words) {
    if (words[0] == "v") return AddVertex(words);
    if (words[0] == "f") return AddFace(words);
    if (IsCurved(words[0])) return Bad("begins a curved surface; triangles are needed");
    if (absl::ascii_isalpha(static_cast<unsigned char>(words[0].front()))) return absl::OkStatus();
    return Bad(absl::StrCat("begins with \"", absl::CHexEscape(words[0].substr(0, 20)),
                            "\", and the line before does not continue"));
  }

  absl::Status AddVertex(const Words& words) {
    if (words.size() < 4 || words.size() > kMaxVertexWords) {
      return Bad(absl::StrCat("has a vertex of ", words.size() - 1, " numbers"));
    }
    std::array<double, kMaxVertexWords> numbers{};
    for (std::size_t i = 1; i < words.size(); ++i) {
      double& number = numbers[i - 1];
      if (absl::SimpleAtod(words[i], &number) &&
          std::abs(number) <= static_cast<double>(std::numeric_limits<float>::max())) {
        continue;
      }
      return Bad(absl::StrCat("has \"", absl::CHexEscape(words[i].substr(0, 20)),
                              "\" where a finite number belongs"));
    }
    absl::StrAppendFormat(&out_, "v %.9g %.9g %.9g\n", numbers[0], numbers[1], numbers[2]);
    ++vertex_count_;
    return absl::OkStatus();
  }

  // The position of a corner from 1 on, of words such as 3, 3/1, 3//2 and -1.
  std::optional<std::int64_t> Corner(absl::string_view word) const {
    std::int64_t corner = 0;
    if (!absl::SimpleAtoi(word.substr(0, word.find('/')), &corner)) return std::nullopt;
    if (corner < 0) corner += vertex_count_ + 1;
    return corner < 1 ? std::nullopt : std::optional(corner);
  }

  absl::Status AddFace(const Words& words) {
    if (words.size() < 4) return Bad("has a face with fewer than three corners");
    out_ += 'f';
    for (std::size_t i = 1; i < words.size(); ++i) {
      const std::optional<std::int64_t> corner = Corner(words[i]);
      if (!corner) {
        return Bad(absl::StrCat("has a face with the corner \"",
                                absl::CHexEscape(words[i].substr(0, 20)), "\""));
      }
      absl::StrAppend(&out_, " ", *corner);
      if (*corner <= last_corner_) continue;
      last_corner_ = *corner;
      last_corner_line_ = line_;
    }
    out_ += '\n';
    return absl::OkStatus();
  }

  absl::string_view text_;
  std::string out_;
  std::int64_t line_ = 0;
  std::int64_t vertex_count_ = 0;
  std::int64_t last_corner_ = 0;
  std::int64_t last_corner_line_ = 0;
};

}  // namespace

absl::StatusOr<std::string> PlainObj(std::string_view text) {
  return ObjReader(absl::string_view(text.data(), text.size())).Read();
}

}  // namespace graspdb::rendering
