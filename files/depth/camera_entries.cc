#include "files/depth/camera_entries.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace graspdb::files {
namespace {

using google::protobuf::Value;

constexpr int kDeepest = 4;
constexpr std::size_t kLongestKey = 64;  // bytes of a key in a path

std::string NameOf(const std::string& key) {
  std::string out;
  for (const char c : key.substr(0, kLongestKey)) {
    const auto byte = static_cast<unsigned char>(c);
    if (absl::ascii_isalnum(byte)) out += absl::ascii_tolower(byte);
  }
  return out;
}

// The numbers of a list, or of a list of lists of numbers; none where anything else is in it.
std::vector<double> NumbersOf(const google::protobuf::ListValue& list) {
  std::vector<double> out;
  for (const Value& value : list.values()) {
    if (value.has_number_value()) {
      out.push_back(value.number_value());
      continue;
    }
    if (!value.has_list_value()) return {};
    for (const Value& inner : value.list_value().values()) {
      if (!inner.has_number_value()) return {};
      out.push_back(inner.number_value());
    }
  }
  return out;
}

std::string FirstTextOf(const google::protobuf::ListValue& list) {
  for (const Value& value : list.values()) {
    if (value.has_string_value() && !value.string_value().empty()) return value.string_value();
  }
  return "";
}

class Collector {
 public:
  bool Add(const CameraEntry& parent, const std::string& key, const Value& value, int depth) {
    CameraEntry entry;
    entry.path = absl::StrCat(parent.path, parent.path.empty() ? "" : ".",
                              absl::Utf8SafeCEscape(key.substr(0, kLongestKey)));
    entry.name = NameOf(key);
    if (entry.name == "data" || entry.name == "values") entry.name = parent.name;
    if (value.has_struct_value()) return AddAll(entry, value.struct_value(), depth + 1);
    if (value.has_number_value()) entry.numbers = {value.number_value()};
    if (value.has_string_value()) entry.text = value.string_value();
    if (value.has_list_value()) {
      entry.numbers = NumbersOf(value.list_value());
      entry.text = FirstTextOf(value.list_value());
      if (entry.numbers.empty() && !AddObjects(entry, value.list_value(), depth)) return false;
    }
    entries_.push_back(std::move(entry));
    return true;
  }
  bool AddAll(const CameraEntry& parent, const google::protobuf::Struct& document, int depth) {
    return depth <= kDeepest && std::ranges::all_of(document.fields(), [&](const auto& field) {
             return Add(parent, field.first, field.second, depth);
           });
  }
  std::vector<CameraEntry> TakeSorted() {
    std::ranges::sort(entries_, {}, &CameraEntry::path);
    return std::move(entries_);
  }

 private:
  bool AddObjects(const CameraEntry& parent, const google::protobuf::ListValue& list, int depth) {
    return std::ranges::all_of(list.values(), [&](const Value& value) {
      return !value.has_struct_value() || AddAll(parent, value.struct_value(), depth + 1);
    });
  }

  std::vector<CameraEntry> entries_;
};

}  // namespace

absl::StatusOr<std::vector<CameraEntry>> CameraEntriesOf(const google::protobuf::Struct& document) {
  Collector collector;
  if (!collector.AddAll({}, document, 0)) {
    return absl::InvalidArgumentError(absl::StrCat("nests objects more than ", kDeepest, " deep"));
  }
  return collector.TakeSorted();
}

}  // namespace graspdb::files
