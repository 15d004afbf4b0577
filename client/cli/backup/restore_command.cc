#include "client/cli/backup/restore_command.h"

#include <cstdint>
#include <memory>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "client/cli/base/beside_program.h"

namespace graspdb::client {
namespace {

struct RestoreOptions {
  std::string from;
  std::string to;
  std::uint32_t id = 0;  // 0: the newest
  bool dry_run = false;
};

absl::Status Restore(const GlobalOptions& global, const RestoreOptions& options) {
  std::vector<std::string> more = {"--to", options.to};
  if (options.id != 0) more.insert(more.end(), {"--id", std::to_string(options.id)});
  if (options.dry_run) more.emplace_back("--dry-run");
  return ReadFolder(global, "restore", options.from, more);
}

// "7" for "backups/7".
std::string RemovePrefix(std::string& text) {
  constexpr std::string_view kPrefix = "backups/";
  if (text.starts_with(kPrefix)) text.erase(0, kPrefix.size());
  return "";  // no error
}

}  // namespace

void AcceptBackupName(CLI::Option* number) {
  number->transform(CLI::Validator(RemovePrefix, ""))->check(WholeNumberFrom(1));
}

absl::Status ReadFolder(const GlobalOptions& global, const std::string& command,
                        const std::string& from, const std::vector<std::string>& more) {
  std::vector<std::string> arguments = {"backup", command, "--from", from};
  arguments.insert(arguments.end(), more.begin(), more.end());
  if (global.json) arguments.emplace_back("--json");
  const absl::Status failed = BecomeProgram("graspdb-server", std::move(arguments));
  return {failed.code(), absl::StrCat("'backup ", command, "' ", failed.message())};
}

void AddRestoreCommand(CLI::App& backup, const GlobalOptions& global, Action* action) {
  auto options = std::make_shared<RestoreOptions>();
  CLI::App* command = AddCommand(backup, "restore", "Restore a backup to an empty folder");
  command->add_option("--from", options->from, "Folder of the backups")->required();
  command->add_option("--to", options->to, "Directory of the database to make: missing or empty")
      ->required();
  AcceptBackupName(
      command->add_option("--id", options->id, "Number of the backup; default: the newest"));
  command->add_flag(
      "--dry-run", options->dry_run,
      "Change nothing: verify the backup, and print what a restore would change in an "
      "existing database");
  command->footer(
      "No server is needed. Then start one on the folder.\n\n"
      "Example: graspdb backup restore --from /mnt/backups/graspdb --to /var/lib/graspdb/db");
  command->callback([=, &global] { *action = [=, &global] { return Restore(global, *options); }; });
}

}  // namespace graspdb::client
