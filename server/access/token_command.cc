#include "server/access/token_command.h"

#include <fcntl.h>
#include <google/protobuf/util/json_util.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/settings_file.h"
#include "server/access/identities.h"
#include "server/access/method_role.h"
#include "storage/base/folder_sync.h"
#include "storage/records/resource_name.h"

namespace graspdb::server {
namespace {

constexpr char kTokenFooter[] =
    R"(The token is shown only once; the file of identities has its SHA-256. Example:
  graspdb-server token press-3 --role read --role recognise --cell press-3 \
    --out press-3.token >> identities.jsonl)";

// In the order of the contract, which begins with the least.
std::vector<std::string> RoleNames() {
  std::vector<std::string> out;
  out.reserve(static_cast<std::size_t>(v1::Role_MAX));
  for (int role = v1::ROLE_READ; role <= v1::Role_MAX; ++role) {
    out.push_back(RoleName(static_cast<v1::Role>(role)));
  }
  return out;
}

// Of one of RoleNames().
v1::Role RoleNamed(const std::string& name) {
  int role = v1::ROLE_READ;
  while (RoleName(static_cast<v1::Role>(role)) != name) ++role;
  return static_cast<v1::Role>(role);
}

// A new file that only its owner can read, on the disk: nothing else has the secret. No file stays
// after an error.
absl::Status WriteSecret(const std::string& path, const std::string& secret) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  const bool is_new = file >= 0;
  const bool written =
      is_new && write(file, secret.data(), secret.size()) == static_cast<ssize_t>(secret.size()) &&
      fsync(file) == 0;
  std::error_code error;
  if (!written) error.assign(errno == 0 ? EIO : errno, std::generic_category());
  if (is_new && close(file) != 0 && !error) error.assign(errno, std::generic_category());
  if (!error) {
    error = storage::SyncFolder(std::filesystem::path(path).parent_path(),
                                storage::Unreadable::kIsAccepted);
  }
  if (!error) return absl::OkStatus();
  if (is_new) unlink(path.c_str());
  const char* const advice = error == std::errc::file_exists
                                 ? "choose another file, or move this one away"
                                 : "check the disk and the permissions of its folder";
  return absl::FailedPreconditionError(
      absl::StrCat("cannot write --out ", path, " (", error.message(), "); ", advice));
}

absl::Status MakeToken(v1::Identity identity, const std::string& out) {
  const std::string token = NewToken();
  if (token.empty()) return absl::InternalError("the system has no random numbers");
  identity.add_token_sha256(HashToken(token));
  RETURN_IF_ERROR(CheckIdentity(identity));
  std::string line;
  if (!google::protobuf::util::MessageToJsonString(identity, &line).ok()) {
    return absl::InternalError("the identity has no JSON");
  }
  if (out.empty()) {
    std::printf("%s\n", token.c_str());
  } else {
    RETURN_IF_ERROR(WriteSecret(out, token + "\n"));
  }
  std::printf("%s\n", line.c_str());
  return absl::OkStatus();
}

}  // namespace

int RunTokenCommand(int argc, char** argv) {
  CLI::App app("Makes a token: prints it, then the line for the file of --identities.",
               "graspdb-server token");
  app.footer(kTokenFooter);
  std::string name;
  std::string cell;
  std::string out;
  std::vector<std::string> roles;
  app.add_option("NAME", name, "Name of the caller: a program or a person")->required();
  app.add_option("--role", roles,
                 "A role: read, recognise, teach, operate or admin; may be repeated")
      ->required()
      ->check(CLI::IsMember(RoleNames()))
      ->type_name("ROLE");
  app.add_option("--cell", cell, "Id of the only cell that the caller may use");
  app.add_option("--out", out, "New file for the token, instead of the first line of the output");
  if (const std::optional<int> end = ParseArguments(app, argc, argv)) return *end;
  v1::Identity identity;
  identity.set_name(name);
  for (const std::string& role : roles) identity.add_roles(RoleNamed(role));
  if (!cell.empty()) identity.set_cell(storage::MakeCellName(cell));
  const absl::Status status = MakeToken(std::move(identity), out);
  if (status.ok()) return 0;
  std::fprintf(stderr, "graspdb-server: %s\n", std::string(status.message()).c_str());
  return absl::IsInvalidArgument(status) ? 2 : 1;
}

}  // namespace graspdb::server
