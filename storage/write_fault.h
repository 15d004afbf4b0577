// Why a database cannot be written.
#pragma once

#include "absl/status/status.h"
#include "absl/time/time.h"

namespace graspdb::storage {

struct WriteFault {
  absl::Status error;  // OK: writes succeed
  absl::Time begin;    // of the fault
};

}  // namespace graspdb::storage
