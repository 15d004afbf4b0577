// Checks of writes: labels, release states, updates of some fields (AIP-134, 161), and what a
// repeated write is recognised by.
#pragma once

#include <google/protobuf/field_mask.pb.h>
#include <google/protobuf/repeated_field.h>
#include <google/protobuf/util/field_mask_util.h>

#include <algorithm>
#include <span>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "graspdb/v1/catalog.pb.h"
#include "server/base/errors.h"

namespace graspdb::server {

// In lower case; empty where the request has none. INVALID_ARGUMENT with the field unless it is a
// UUID of version 4.
absl::StatusOr<std::string> WriteIdFromProto(std::string_view request_id);

// SHA-256 of `content`: 32 bytes.
std::string Sha256(std::string_view content);

// INVALID_ARGUMENT unless the labels are distinct and written like ids; `path` is that of the
// field.
absl::Status CheckLabels(const google::protobuf::RepeatedPtrField<std::string>& labels,
                         std::string_view path);

// INVALID_ARGUMENT for a number that is no state.
absl::Status CheckRelease(v1::ReleaseState release, std::string_view path);

// Copies the masked fields of `from` into `to`; an empty mask means all of
// `mutable_fields`. INVALID_ARGUMENT for a path that does not exist or may not be
// changed.
template <typename Resource>
absl::Status ApplyUpdate(const Resource& from, const google::protobuf::FieldMask& mask,
                         std::span<const std::string_view> mutable_fields, Resource* to) {
  using google::protobuf::util::FieldMaskUtil;
  google::protobuf::FieldMask effective = mask;
  if (effective.paths().empty()) {
    for (const std::string_view field : mutable_fields) effective.add_paths(std::string(field));
  }
  for (const std::string& path : effective.paths()) {
    const std::string_view top = std::string_view(path).substr(0, path.find('.'));
    if (path.ends_with('.') || std::ranges::find(mutable_fields, top) == mutable_fields.end() ||
        !FieldMaskUtil::IsValidPath<Resource>(path)) {
      return InvalidField("update_mask",
                          absl::StrCat("\"", path, "\" is not a field that can be changed"));
    }
  }
  FieldMaskUtil::MergeOptions options;
  options.set_replace_message_fields(true);
  options.set_replace_repeated_fields(true);
  FieldMaskUtil::MergeMessageTo(from, effective, options, to);
  to->DiscardUnknownFields();  // nothing bounds them
  return absl::OkStatus();
}

// ApplyUpdate() of a record with a release state, which stays where the update has none: a client
// that does not know it must not release a draft.
template <typename Record>
absl::Status ApplyReleasedUpdate(const Record& from, const google::protobuf::FieldMask& mask,
                                 std::span<const std::string_view> mutable_fields, Record* to) {
  const v1::ReleaseState release = to->release();
  absl::Status status = ApplyUpdate(from, mask, mutable_fields, to);
  if (to->release() == v1::RELEASE_STATE_UNSPECIFIED) to->set_release(release);
  return status;
}

}  // namespace graspdb::server
