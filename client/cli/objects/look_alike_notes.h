// Look-alikes in a catalogue, reported after teaching.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "client/sdk/client.h"

namespace graspdb::client {

// Prints the look-alikes of the object with this resource name on stderr; of all objects if "". If
// the catalogue (see `status`) is large, prints only the command that compares it. Errors of
// Client::FindLookAlikes.
absl::Status NoteLookAlikes(Client& client, const std::string& object,
                            const v1::CatalogStatus& status);

}  // namespace graspdb::client
