// The page of a report, which the program graspdb-eval-report makes.
#pragma once

#include <filesystem>

#include "absl/status/status.h"

namespace graspdb::lab {

// Runs graspdb-eval-report, which is beside this program, on the folder of a ReportWriter and waits
// for it. UNAVAILABLE, with the command for later, where it does not start or fails, e.g. since
// matplotlib is not installed.
absl::Status MakeReportPage(const std::filesystem::path& folder);

}  // namespace graspdb::lab
