// What a catalogue may confuse, told after teaching.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "client/sdk/client.h"

namespace graspdb::client {

// Prints on stderr what the stable poses of the object of that resource name may be taken for; of
// all objects for "". A large catalogue, as `status` says, is not compared unasked: then how to
// ask. Errors of Client::FindLookAlikes.
absl::Status NoteLookAlikes(Client& client, const std::string& object,
                            const v1::CatalogStatus& status);

}  // namespace graspdb::client
