#include "client/cli/backup/backup_commands.h"

#include <google/protobuf/util/time_util.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "program/text/printable_text.h"

namespace graspdb::client {
namespace {

struct RestoreOptions {
  std::string from;
  std::string to;
  std::uint32_t id = 0;  // 0: the newest
  bool dry_run = false;
};

// Replaces this process with `graspdb-server backup COMMAND --from FOLDER ...`. Returns only if
// that fails.
absl::Status ReadFolder(const GlobalOptions& global, const std::string& command,
                        const std::string& from, const std::vector<std::string>& more) {
  std::vector<std::string> arguments = {"backup", command, "--from", from};
  arguments.insert(arguments.end(), more.begin(), more.end());
  if (global.json) arguments.emplace_back("--json");
  const absl::Status failed = BecomeProgram("graspdb-server", std::move(arguments));
  return {failed.code(), absl::StrCat("'backup ", command, "' ", failed.message())};
}

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

// Lets an option for the number of a backup take its name too, as `backup list` prints it.
void AcceptBackupName(CLI::Option* number) {
  number->transform(CLI::Validator(RemovePrefix, ""))->check(WholeNumberFrom(1));
}

// Adds `backup restore`.
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

struct BackupOptions {
  std::string from;
  std::uint32_t id = 0;  // 0: the newest
  std::vector<std::uint32_t> ids;
};

std::string NameOf(std::uint32_t id) { return ResourceName("backups", std::to_string(id)); }

absl::StatusOr<std::string> ChooseBackup(Client& client, const BackupOptions& options) {
  if (options.id != 0) return NameOf(options.id);
  ASSIGN_OR_RETURN(const auto backups, client.ListBackups());
  if (!backups.empty()) return backups.back().name();
  return absl::NotFoundError("there are no backups; make one with: graspdb backup create");
}

absl::Status Print(const GlobalOptions& global, const v1::Backup& backup) {
  if (global.json) return PrintJson(backup);
  if (!backup.damage().empty()) {
    std::printf("%-12s %s\n", backup.name().c_str(), PrintableText(backup.damage()).c_str());
    return absl::OkStatus();
  }
  std::printf("%s\n", absl::StrFormat(
                          "%-12s %s: revision %d, %d objects, %d views, %.1f MiB", backup.name(),
                          google::protobuf::util::TimeUtil::ToString(backup.create_time()),
                          backup.catalog_revision(), backup.object_count(), backup.view_count(),
                          static_cast<double>(backup.byte_count()) / (1 << 20))
                          .c_str());
  return absl::OkStatus();
}

// Prints the progress where a person sees it; Ctrl-C ends the call and with it the server's work.
absl::Status OnBytes(std::int64_t bytes) {
  if (Interrupted()) return absl::CancelledError("interrupted; nothing was changed");
  if (isatty(STDERR_FILENO) == 1) {
    std::fprintf(stderr, "\r%lld MiB\r", static_cast<long long>(bytes >> 20));
  }
  return absl::OkStatus();
}

absl::Status Create(const GlobalOptions& global) {
  ASSIGN_OR_RETURN(const auto made, Connect(global).CreateBackup(OnBytes));
  return Print(global, made);
}

absl::Status List(const GlobalOptions& global, const BackupOptions& options) {
  if (!options.from.empty()) return ReadFolder(global, "list", options.from, {});
  ASSIGN_OR_RETURN(const auto backups, Connect(global).ListBackups());
  for (const v1::Backup& backup : backups) {
    RETURN_IF_ERROR(Print(global, backup));
  }
  if (backups.empty() && !global.json) {
    std::printf("there are no backups; make one with: graspdb backup create\n");
  }
  return absl::OkStatus();
}

absl::Status Verify(const GlobalOptions& global, const BackupOptions& options) {
  if (!options.from.empty()) {
    std::vector<std::string> id;
    if (options.id != 0) id = {"--id", std::to_string(options.id)};
    return ReadFolder(global, "verify", options.from, id);
  }
  Client client = Connect(global);
  ASSIGN_OR_RETURN(const auto name, ChooseBackup(client, options));
  ASSIGN_OR_RETURN(const auto verified, client.VerifyBackup(name, OnBytes));
  return Print(global, verified);
}

absl::Status Diff(const GlobalOptions& global, const BackupOptions& options) {
  Client client = Connect(global);
  ASSIGN_OR_RETURN(const auto name, ChooseBackup(client, options));
  std::array<int, 4> counts{};
  const auto print = [&](const v1::CompareBackupResponse& some) -> absl::Status {
    if (Interrupted()) return absl::CancelledError("interrupted");
    for (const v1::BackupDifference& difference : some.differences()) {
      const auto kind = static_cast<std::size_t>(difference.kind());
      constexpr std::array<char, 4> kSigns = {'?', '+', '~', '-'};
      if (kind < kSigns.size()) ++counts[kind];
      if (global.json) {
        RETURN_IF_ERROR(PrintJson(difference));
      } else {
        std::printf("%c %s\n", kind < kSigns.size() ? kSigns[kind] : '?',
                    difference.name().c_str());
      }
    }
    return absl::OkStatus();
  };
  ASSIGN_OR_RETURN(const auto compared, client.CompareBackup(name, print));
  if (global.json) return absl::OkStatus();
  std::printf("restoring %s (revision %lld) would add %d records, change %d and remove %d\n",
              compared.name().c_str(), static_cast<long long>(compared.catalog_revision()),
              counts[v1::BackupDifference::KIND_ADDED], counts[v1::BackupDifference::KIND_CHANGED],
              counts[v1::BackupDifference::KIND_REMOVED]);
  return absl::OkStatus();
}

absl::Status Delete(const GlobalOptions& global, const BackupOptions& options) {
  Client client = Connect(global);
  for (const std::uint32_t id : options.ids) {
    RETURN_IF_ERROR(client.DeleteBackup(NameOf(id)));
    if (!global.json) std::printf("deleted %s\n", NameOf(id).c_str());
  }
  return absl::OkStatus();
}

}  // namespace

void AddBackupCommands(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* backup = AddCommand(app, "backup", "Make, list, verify, compare and restore backups");
  backup->require_subcommand(1);
  auto options = std::make_shared<BackupOptions>();
  const auto add = [&](const char* name, const char* text, auto run) {
    CLI::App* command = AddCommand(*backup, name, text);
    command->callback([=, &global] { *action = [=, &global] { return run(global, *options); }; });
    return command;
  };
  const auto add_id = [&](CLI::App* command) {
    AcceptBackupName(
        command->add_option("ID", options->id, "Number of the backup; default: the newest"));
  };
  const auto add_from = [&](CLI::App* command) {
    command->add_option("--from", options->from,
                        "Folder of backups to read, in place of the server's");
  };
  add("create", "Make a backup of the server's catalogue in its --backup-dir",
      [](const GlobalOptions& all, const BackupOptions& /*unused*/) { return Create(all); });
  add_from(add("list", "List the backups", List));
  CLI::App* verify = add("verify", "Read every byte of a backup and compare the checksums", Verify);
  add_id(verify);
  add_from(verify);
  add_id(add("diff",
             "Print what a restore would change in the server's catalogue: + added, ~ changed, - "
             "removed",
             Diff));
  AcceptBackupName(add("delete", "Delete backups", Delete)
                       ->add_option("ID", options->ids, "Numbers of the backups")
                       ->required());
  AddRestoreCommand(*backup, global, action);
}

}  // namespace graspdb::client
