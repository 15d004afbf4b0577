#include "lab/commands/report_page.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <string>

#include "absl/strings/str_cat.h"

namespace graspdb::lab {
namespace {

constexpr char kProgram[] = "graspdb-eval-report";

}  // namespace

absl::Status MakeReportPage(const std::filesystem::path& folder) {
  std::error_code unknown;  // the program is then not found
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", unknown);
  std::string program = here.parent_path() / kProgram;
  std::string argument = folder.string();
  const std::array<char*, 3> arguments = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  int status = 0;
  if (posix_spawn(&child, program.c_str(), nullptr, nullptr, arguments.data(), environ) == 0 &&
      waitpid(child, &status, 0) == child && status == 0) {
    return absl::OkStatus();
  }
  return absl::UnavailableError(
      absl::StrCat(kProgram,
                   " made no report.html; install python3-matplotlib if it is missing, "
                   "then run: ",
                   kProgram, " ", folder.string()));
}

}  // namespace graspdb::lab
