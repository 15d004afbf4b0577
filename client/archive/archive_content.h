// The content of records: what two servers have to agree in to have the same.
#pragma once

#include "absl/time/time.h"
#include "graspdb/v1/catalog.pb.h"

namespace graspdb::client {

// Without the fields that a server sets: name, times, etag, counts of outcomes.
v1::Object ContentOf(v1::Object object);
v1::StablePose ContentOf(v1::StablePose pose);

bool IsSame(const v1::Object& a, const v1::Object& b);
bool IsSame(const v1::StablePose& a, const v1::StablePose& b);
// Poses may differ by rounding (1e-9): earlier servers normalise them with each upload. Both with
// their clouds.
bool IsSame(const v1::View& a, const v1::View& b);
// Of all but the clouds; false without the need to read them.
bool MayBeSame(const v1::View& a, const v1::View& b);

// When its content was last changed: of a view, when it was taught.
absl::Time ChangeTimeOf(const v1::Object& object);
absl::Time ChangeTimeOf(const v1::StablePose& pose);
absl::Time ChangeTimeOf(const v1::View& view);

}  // namespace graspdb::client
