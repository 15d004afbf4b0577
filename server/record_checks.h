// Labels and release states in requests.
#pragma once

#include <google/protobuf/field_mask.pb.h>
#include <google/protobuf/repeated_field.h>

#include <span>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "graspdb/v1/catalog.pb.h"
#include "server/errors.h"
#include "server/update_mask.h"

namespace graspdb::server {

// INVALID_ARGUMENT unless the labels are distinct and written like ids; `path` is that of the
// field.
absl::Status CheckLabels(const google::protobuf::RepeatedPtrField<std::string>& labels,
                         std::string_view path);

// INVALID_ARGUMENT for a number that is no state.
absl::Status CheckRelease(v1::ReleaseState release, std::string_view path);

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
