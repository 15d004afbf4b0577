#include "storage/records/resource_name.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "base/status_macros.h"

namespace graspdb::storage {
namespace {

constexpr std::size_t kMaxIdLength = 63;
// Names longer than this are cut in messages, so that hostile input does not fill the log.
constexpr std::size_t kMaxQuotedLength = 80;

constexpr std::string_view kObjects = "objects";
constexpr std::string_view kStablePoses = "stablePoses";
constexpr std::string_view kViews = "views";
constexpr std::string_view kCells = "cells";
constexpr std::string_view kUploads = "uploads";

bool IsAlphanumeric(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

bool IsIdCharacter(char c) { return IsAlphanumeric(c) || c == '_' || c == '.' || c == '-'; }

bool IsId(std::string_view id) {
  return !id.empty() && id.size() <= kMaxIdLength && IsAlphanumeric(id.front()) &&
         std::all_of(id.begin(), id.end(), IsIdCharacter);
}

// The text in quotes, with unprintable characters replaced.
std::string Quote(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text.substr(0, kMaxQuotedLength)) {
    quoted += (c >= ' ' && c <= '~') ? c : '?';
  }
  quoted += text.size() > kMaxQuotedLength ? "...\"" : "\"";
  return quoted;
}

// Splits `name` into the ids that follow each of `collections`.
template <std::size_t N>
absl::StatusOr<std::array<std::string, N>> ParseName(
    std::string_view name, const std::array<std::string_view, N>& collections,
    std::string_view form) {
  std::array<std::string, N> ids;
  std::string_view rest = name;
  bool matches = true;
  for (std::size_t i = 0; i < N && matches; ++i) {
    const std::string_view collection = collections[i];
    matches = rest.starts_with(collection) && rest.substr(collection.size()).starts_with('/');
    if (!matches) break;
    rest.remove_prefix(collection.size() + 1);
    const std::size_t end = std::min(rest.find('/'), rest.size());
    ids[i] = std::string(rest.substr(0, end));
    const bool last = i + 1 == N;
    matches = IsId(ids[i]) && (end == rest.size()) == last;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  if (matches) return ids;
  return absl::InvalidArgumentError(
      Quote(name) + " is not a name of the form " + std::string(form) +
      "; give ids of 1 to 63 characters of [A-Za-z0-9_.-] that begin with a letter or a digit");
}

}  // namespace

absl::Status ValidateResourceId(std::string_view id) {
  if (IsId(id)) return absl::OkStatus();
  return absl::InvalidArgumentError(Quote(id) +
                                    " is not an id; give 1 to 63 characters of [A-Za-z0-9_.-] that "
                                    "begin with a letter or a digit");
}

absl::StatusOr<ObjectName> ParseObjectName(std::string_view name) {
  ASSIGN_OR_RETURN(auto ids, ParseName<1>(name, {kObjects}, "objects/{object}"));
  return ObjectName{ids[0]};
}

absl::StatusOr<StablePoseName> ParseStablePoseName(std::string_view name) {
  ASSIGN_OR_RETURN(auto ids, ParseName<2>(name, {kObjects, kStablePoses},
                                          "objects/{object}/stablePoses/{stable_pose}"));
  return StablePoseName{ids[0], ids[1]};
}

absl::StatusOr<ViewName> ParseViewName(std::string_view name) {
  ASSIGN_OR_RETURN(auto ids,
                   ParseName<3>(name, {kObjects, kStablePoses, kViews},
                                "objects/{object}/stablePoses/{stable_pose}/views/{view}"));
  return ViewName{ids[0], ids[1], ids[2]};
}

absl::Status CheckCellName(std::string_view name) {
  return ParseName<1>(name, {kCells}, "cells/{cell}").status();
}

absl::Status CheckUploadName(std::string_view name) {
  return ParseName<1>(name, {kUploads}, "uploads/{upload}").status();
}

std::string MakeObjectName(std::string_view object_id) {
  return std::string(kObjects) + "/" + std::string(object_id);
}

std::string MakeStablePoseName(std::string_view object_id, std::string_view stable_pose_id) {
  return MakeObjectName(object_id) + "/" + std::string(kStablePoses) + "/" +
         std::string(stable_pose_id);
}

std::string MakeViewName(std::string_view object_id, std::string_view stable_pose_id,
                         std::string_view view_id) {
  return MakeStablePoseName(object_id, stable_pose_id) + "/" + std::string(kViews) + "/" +
         std::string(view_id);
}

std::string MakeCellName(std::string_view cell_id) {
  return std::string(kCells) + "/" + std::string(cell_id);
}

std::string MakeUploadName(std::string_view upload_id) {
  return std::string(kUploads) + "/" + std::string(upload_id);
}

}  // namespace graspdb::storage
