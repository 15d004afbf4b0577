#include "rendering/meshes/stl_facets.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "base/status_macros.h"

namespace graspdb::rendering {
namespace {

constexpr std::size_t kStlHeaderBytes = 80;
constexpr std::size_t kFirstFacet = kStlHeaderBytes + sizeof(std::uint32_t);
constexpr std::size_t kFacetBytes = 50;

std::uint64_t DeclaredBytes(std::string_view bytes) {
  std::uint32_t count = 0;
  bytes.copy(reinterpret_cast<char*>(&count), sizeof(count), kStlHeaderBytes);
  return kFirstFacet + std::uint64_t{kFacetBytes} * count;
}

bool IsText(absl::string_view bytes) {
  return absl::StartsWithIgnoreCase(absl::StripLeadingAsciiWhitespace(bytes), "solid");
}

// Facets of text, word by word.
class StlText {
 public:
  explicit StlText(absl::string_view text) : text_(text) { out_.resize(kFirstFacet, '\0'); }

  absl::StatusOr<std::string> Read() {
    std::uint32_t count = 0;
    for (std::string word = Next(); !word.empty(); word = Next()) {
      if (word == "solid" || word == "endsolid") {
        is_open_ = word == "solid";
        SkipLine();  // its name
        continue;
      }
      if (word != "facet") return Unexpected(word, "facet or endsolid");
      RETURN_IF_ERROR(AddFacet());
      ++count;
    }
    if (is_open_) return absl::InvalidArgumentError("it is cut short, as no endsolid ends it");
    std::memcpy(out_.data() + kStlHeaderBytes, &count, sizeof(count));
    return std::move(out_);
  }

 private:
  // In lower case; empty at the end.
  std::string Next() {
    constexpr absl::string_view kSpaces = " \t\r\n";
    std::size_t at = 0;
    for (; at < text_.size() && absl::StrContains(kSpaces, text_[at]); ++at) {
      line_ += text_[at] == '\n' ? 1 : 0;
    }
    text_.remove_prefix(at);
    const absl::string_view word = text_.substr(0, text_.find_first_of(kSpaces));
    text_.remove_prefix(word.size());
    return absl::AsciiStrToLower(word);
  }

  void SkipLine() { text_.remove_prefix(std::min(text_.find('\n'), text_.size())); }

  absl::Status Unexpected(const std::string& word, absl::string_view expected) const {
    if (word.empty()) return absl::InvalidArgumentError("it is cut short within a facet");
    return absl::InvalidArgumentError(absl::StrCat("line ", line_, " has \"",
                                                   absl::CHexEscape(word.substr(0, 20)),
                                                   "\" where ", expected, " belongs"));
  }

  absl::Status Expect(absl::string_view expected) {
    const std::string word = Next();
    return word == expected ? absl::OkStatus() : Unexpected(word, expected);
  }

  absl::Status AddVertex() {
    for (int axis = 0; axis < 3; ++axis) {
      const std::string word = Next();
      double number = 0;
      const bool is_number = absl::SimpleAtod(word, &number);
      const bool fits = std::abs(number) <= static_cast<double>(std::numeric_limits<float>::max());
      if (!is_number || !fits) return Unexpected(word, "a finite number");
      const auto value = static_cast<float>(number);
      out_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    }
    return absl::OkStatus();
  }

  // Normals are not used, and those of triangles without area may be no numbers, as -1.#IND.
  void SkipNormal() {
    for (int axis = 0; axis < 3; ++axis) Next();
    out_.append(3 * sizeof(float), '\0');
  }

  absl::Status AddFacet() {
    absl::Status status = Expect("normal");
    SkipNormal();
    if (status.ok()) status = Expect("outer");
    if (status.ok()) status = Expect("loop");
    for (int corner = 0; status.ok() && corner < 3; ++corner) {
      status = Expect("vertex");
      if (status.ok()) status = AddVertex();
    }
    if (status.ok()) status = Expect("endloop");
    if (status.ok()) status = Expect("endfacet");
    out_.append(2, '\0');
    return status;
  }

  absl::string_view text_;
  std::string out_;
  std::int64_t line_ = 1;
  bool is_open_ = false;
};

}  // namespace

bool IsBinaryStl(std::string_view bytes) {
  return bytes.size() >= kFirstFacet && bytes.size() == DeclaredBytes(bytes);
}

absl::StatusOr<std::string> BinaryStl(std::string_view bytes) {
  const absl::string_view view(bytes.data(), bytes.size());
  if (IsBinaryStl(bytes)) return std::string(bytes);
  if (IsText(view)) return StlText(view).Read();
  if (bytes.size() < kFirstFacet) return absl::InvalidArgumentError("it is no STL file");
  return absl::InvalidArgumentError(absl::StrCat("its header promises ", DeclaredBytes(bytes),
                                                 " bytes, and it has ", bytes.size()));
}

std::string StlDescription(std::string_view bytes) {
  std::string text(bytes.substr(
      0, IsBinaryStl(bytes) ? kStlHeaderBytes : std::min(bytes.find('\n'), bytes.size())));
  std::ranges::replace(text, '\0', ' ');
  return text;
}

}  // namespace graspdb::rendering
