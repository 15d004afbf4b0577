#include "client/cli/base/beside_program.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"

namespace graspdb::client {

absl::Status BecomeProgram(const std::string& program, std::vector<std::string> arguments) {
  std::error_code error;
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string path = here.parent_path() / program;
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  execv(path.c_str(), argv.data());
  return absl::FailedPreconditionError(absl::StrCat("needs the program ", path,
                                                    ", which does not start (",
                                                    std::strerror(errno), "): install it"));
}

}  // namespace graspdb::client
