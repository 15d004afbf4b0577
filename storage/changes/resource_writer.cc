#include "storage/changes/resource_writer.h"

namespace graspdb::storage {

std::string MakeEtag(std::int64_t revision) { return "r" + std::to_string(revision); }

absl::Status CheckEtag(std::string_view name, std::string_view expected, std::string_view actual) {
  if (expected.empty() || expected == actual) return absl::OkStatus();
  return absl::AbortedError(std::string(name) +
                            " was changed by another client; read it again and retry the change");
}

}  // namespace graspdb::storage
