// Records as the readers and writers of the catalogue get and give them.
#pragma once

#include <string>
#include <vector>

#include "storage/records.pb.h"

namespace graspdb::storage {

// Records in ascending bytewise order of their names.
template <typename Record>
struct Page {
  std::vector<Record> records;
  bool more = false;  // whether records follow; list again after the last name
};

// A view as it is taught. create_time of the record is set by the catalogue.
struct NewView {
  ViewRecord record;
  std::string packed_cloud;  // of PackCloud(); stored as it is
};

enum class PutViewOutcome {
  kCreated,   // stored with a revision of its own
  kExisting,  // a view with that name and digest exists; nothing changed
};

// The new descriptors of a view.
struct DescriptorUpdate {
  std::string view_name;
  std::string content_digest;  // of the view whose cloud they describe
  std::vector<DescriptorRecord> descriptors;
};

}  // namespace graspdb::storage
