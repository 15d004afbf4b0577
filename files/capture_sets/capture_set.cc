#include "files/capture_sets/capture_set.h"

#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <cstdint>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/base/atomic_file.h"
#include "files/capture_sets/capture_check.h"
#include "program/text/json_keys.h"
#include "program/text/read_file.h"

namespace graspdb::files {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxSetBytes = 256 << 20;  // about 500,000 captures

// " at line 3, column 7", or empty when it is unknown. The parser's message ends with
// the text around the place and a line with a caret under it.
std::string PlaceOf(const std::string& message, const std::string& text) {
  const std::size_t first = message.find('\n');
  const std::size_t last = message.rfind('\n');
  if (first == std::string::npos || last == first || message.back() != '^') return "";
  const std::string around = message.substr(first + 1, last - first - 1);
  const std::size_t begin = text.find(around);
  if (around.empty() || begin == std::string::npos) return "";
  if (text.find(around, begin + 1) != std::string::npos) return "";
  const std::size_t place = std::min(begin + (message.size() - last - 2), text.size());
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(place);
  const auto line = std::count(text.begin(), end, '\n') + 1;
  const std::size_t line_begin = text.rfind('\n', place == 0 ? 0 : place - 1);
  const std::size_t column = line_begin == std::string::npos ? place + 1 : place - line_begin;
  return absl::StrCat(" at line ", line, ", column ", column);
}

absl::Status BadJson(const fs::path& path, const std::string& message, const std::string& text) {
  const std::string place = PlaceOf(message, text);
  std::string what = place.empty() ? message : message.substr(0, message.find('\n'));
  std::replace(what.begin(), what.end(), '\n', ' ');
  while (!what.empty() && (what.back() == '.' || what.back() == ' ')) what.pop_back();
  return absl::InvalidArgumentError(absl::StrCat(path.string(), " is not a capture set", place,
                                                 ": ", what, "; correct the file"));
}

// A parser that ignores unknown fields ignores unknown enum values too, and a
// misspelt QUERY must not be taught.
absl::Status CheckSplitWords(const std::string& text) {
  google::protobuf::Struct json;
  if (!google::protobuf::util::JsonStringToMessage(text, &json).ok()) return absl::OkStatus();
  const auto captures = json.fields().find("captures");
  if (captures == json.fields().end()) return absl::OkStatus();
  int number = 0;
  for (const google::protobuf::Value& capture : captures->second.list_value().values()) {
    const auto& fields = capture.struct_value().fields();
    const auto split = fields.find("split");
    v1::Capture::Split known = v1::Capture::SPLIT_UNSPECIFIED;
    if (split != fields.end() && split->second.has_string_value() &&
        !v1::Capture::Split_Parse(split->second.string_value(), &known)) {
      return absl::InvalidArgumentError(absl::StrCat("captures[", number, "].split is \"",
                                                     split->second.string_value(),
                                                     "\"; write TEACH or QUERY"));
    }
    ++number;
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<v1::CaptureSet> LoadCaptureSet(const fs::path& folder) {
  const fs::path path = folder / kCaptureSetFile;
  const absl::StatusOr<std::string> read = ReadTextFile(path, kMaxSetBytes);
  if (absl::IsNotFound(read.status())) {
    return absl::NotFoundError(
        absl::StrCat(path.string(), " does not exist; name the folder of a capture set"));
  }
  if (!read.ok()) return read.status();
  const std::string& text = *read;
  google::protobuf::util::JsonParseOptions options;
  options.ignore_unknown_fields = true;
  v1::CaptureSet set;
  const auto parsed = google::protobuf::util::JsonStringToMessage(text, &set, options);
  if (!parsed.ok()) return BadJson(path, std::string(parsed.message()), text);
  absl::Status checked = CheckJsonKeys(text);
  if (checked.ok()) checked = CheckSplitWords(text);
  if (checked.ok()) checked = CheckCaptureSet(set);
  if (checked.ok()) checked = CheckDistances(set);
  if (checked.ok()) return set;
  return absl::InvalidArgumentError(absl::StrCat(path.string(), ": ", checked.message()));
}

absl::Status SaveCaptureSet(const fs::path& folder, const v1::CaptureSet& set) {
  RETURN_IF_ERROR(CheckCaptureSet(set));
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  std::string text;
  const auto printed = google::protobuf::util::MessageToJsonString(set, &text, options);
  if (!printed.ok()) {
    return absl::InvalidArgumentError(absl::StrCat("the capture set cannot be written as JSON: ",
                                                   std::string(printed.message())));
  }
  return WriteFileAtomically(folder / kCaptureSetFile, text, Durability::kPowerFailure);
}

std::vector<const v1::Capture*> CapturesOf(const v1::CaptureSet& set,
                                           std::optional<v1::Capture::Split> split) {
  const auto wanted = [split](const v1::Capture& capture) {
    if (!split || *split == v1::Capture::SPLIT_UNSPECIFIED || capture.split() == *split) {
      return true;
    }
    if (capture.split() != v1::Capture::SPLIT_UNSPECIFIED) return false;
    const bool named = !capture.object_id().empty() && !capture.stable_pose_id().empty();
    return *split == v1::Capture::QUERY || named;
  };
  std::vector<const v1::Capture*> captures;
  for (const v1::Capture& capture : set.captures()) {
    if (wanted(capture)) captures.push_back(&capture);
  }
  return captures;
}

absl::Status CaptureSetWriter::AddCloud(const std::string& path, const PointFile& cloud) {
  const std::filesystem::path file = folder_ / path;
  if (const auto folder = file.parent_path(); !cloud_folders_.contains(folder)) {
    RETURN_IF_ERROR(MakeDurableFolder(folder));
    cloud_folders_.insert(folder);
  }
  return WritePcd(file, cloud, Durability::kBytes);
}

absl::Status CaptureSetWriter::Finish(const v1::CaptureSet& set) {
  // First, so that no description on the disk lacks its clouds.
  for (const std::filesystem::path& folder : cloud_folders_) {
    RETURN_IF_ERROR(FlushNames(folder));
  }
  return SaveCaptureSet(folder_, set);
}

}  // namespace graspdb::files
