#include "server/backups/backup_program.h"

#include <google/protobuf/util/json_util.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "google/protobuf/util/time_util.h"
#include "program/settings_file.h"
#include "program/text/printable_text.h"
#include "server/backups/backup_messages.h"
#include "storage/backups/backups.h"

namespace graspdb::server {
namespace {

struct BackupProgramOptions {
  std::string from;
  std::string to;
  std::optional<storage::BackupId> id;
  bool dry_run = false;
  bool json = false;
};

absl::Status PrintMessage(const google::protobuf::Message& message) {
  std::string text;
  const auto converted = google::protobuf::util::MessageToJsonString(message, &text);
  if (!converted.ok()) return absl::InternalError(absl::StrCat("no JSON: ", converted.ToString()));
  std::printf("%s\n", text.c_str());
  return absl::OkStatus();
}

std::string TextOf(const storage::Backup& backup) {
  if (!backup.state.ok()) return PrintableText(std::string(backup.state.message()));
  const storage::MetaRecord& meta = backup.record.meta();
  return absl::StrFormat("backup %d of %s: revision %d, %d objects, %d views, %.1f MiB", backup.id,
                         google::protobuf::util::TimeUtil::ToString(backup.record.time()),
                         meta.revision(), meta.object_count(), meta.view_count(),
                         static_cast<double>(backup.byte_count) / (1 << 20));
}

absl::Status Print(const storage::Backup& backup, bool json, const char* done = "") {
  if (json) return PrintMessage(BackupToProto(backup));
  std::printf("%s%s\n", done, TextOf(backup).c_str());
  return absl::OkStatus();
}

// Prints the bytes read so far, where a person sees them.
storage::BackupProgress OnTerminal() {
  storage::BackupProgress progress;
  if (isatty(STDERR_FILENO) == 0) return progress;
  progress.on_bytes = [](std::int64_t bytes) {
    std::fprintf(stderr, "\r%lld MiB read\r", static_cast<long long>(bytes >> 20));
  };
  return progress;
}

absl::StatusOr<storage::BackupId> ChooseId(const storage::Backups& backups,
                                           const BackupProgramOptions& options) {
  if (options.id) return *options.id;
  ASSIGN_OR_RETURN(const auto listed, backups.List());
  if (!listed.empty()) return listed.back().id;
  return absl::NotFoundError(absl::StrCat("there are no backups in ", options.from));
}

absl::Status ListAll(const BackupProgramOptions& options) {
  ASSIGN_OR_RETURN(const auto listed, storage::Backups(options.from).List());
  for (const storage::Backup& backup : listed) {
    RETURN_IF_ERROR(Print(backup, options.json));
  }
  if (listed.empty() && !options.json) std::printf("no backups in %s\n", options.from.c_str());
  return absl::OkStatus();
}

absl::Status VerifyOne(const BackupProgramOptions& options) {
  const storage::Backups backups(options.from);
  ASSIGN_OR_RETURN(const auto id, ChooseId(backups, options));
  ASSIGN_OR_RETURN(const auto verified, backups.Verify(id, OnTerminal()));
  return Print(verified, options.json, "intact: ");
}

// Whether a restore to `folder` would find nothing there.
absl::StatusOr<bool> IsMissingOrEmpty(const std::string& folder) {
  std::error_code error;
  const auto type = std::filesystem::status(folder, error).type();
  if (type == std::filesystem::file_type::not_found) return true;
  if (!error && type != std::filesystem::file_type::directory) {
    return absl::FailedPreconditionError(
        absl::StrCat(folder, " is not a folder; give a new folder as --to"));
  }
  const bool is_empty = !error && std::filesystem::is_empty(folder, error);
  if (!error) return is_empty;
  return absl::UnavailableError(absl::StrCat("the folder ", folder, " cannot be read (",
                                             error.message(),
                                             "); check its permissions, or give another --to"));
}

// Prints what a restore would change in the database at `options.to`.
absl::Status DryRun(const BackupProgramOptions& options, const storage::Backups& backups,
                    storage::BackupId id) {
  std::array<int, 3> counts{};
  const auto print = [&](const storage::Difference& difference) -> absl::Status {
    const auto kind = static_cast<std::size_t>(difference.kind);
    ++counts[kind];
    if (options.json) return PrintMessage(DifferenceToProto(difference));
    constexpr std::array<char, 3> kSigns = {'+', '~', '-'};
    std::printf("%c %s\n", kSigns[kind], difference.name.c_str());
    return absl::OkStatus();
  };
  ASSIGN_OR_RETURN(const auto compared, backups.Compare(id, options.to, {}, print));
  if (options.json) return absl::OkStatus();
  std::printf(
      "%s\nwould add %d records, change %d and remove %d of %s, which is not empty: restore "
      "to a new folder, or move it away first\n",
      TextOf(compared).c_str(), counts[0], counts[1], counts[2], options.to.c_str());
  return absl::OkStatus();
}

absl::Status RestoreOne(const BackupProgramOptions& options) {
  const storage::Backups backups(options.from);
  ASSIGN_OR_RETURN(const auto id, ChooseId(backups, options));
  if (options.dry_run) {
    ASSIGN_OR_RETURN(const bool is_new, IsMissingOrEmpty(options.to));
    if (!is_new) return DryRun(options, backups, id);
    ASSIGN_OR_RETURN(const auto verified, backups.Verify(id, OnTerminal()));
    return Print(verified, options.json, "would restore ");
  }
  ASSIGN_OR_RETURN(const auto restored, backups.Restore(id, options.to, OnTerminal()));
  return Print(restored, options.json, "restored ");
}

// "7" for "backups/7", the name in lists.
std::string RemoveCollection(std::string& text) {
  constexpr std::string_view kPrefix = "backups/";
  if (text.starts_with(kPrefix)) text.erase(0, kPrefix.size());
  return "";  // no error
}

CLI::App* AddBackupCommand(CLI::App& app, const char* name, const char* text,
                           BackupProgramOptions* options, bool has_id) {
  CLI::App* command = app.add_subcommand(name, text);
  command->add_option("--from", options->from, "Folder of the backups")->required();
  command->add_flag("--json", options->json, "Print JSON, one document a line");
  if (has_id) {
    command->add_option("--id", options->id, "Number of the backup; default: the newest")
        ->transform(CLI::Validator(RemoveCollection, ""));
  }
  return command;
}

}  // namespace

int RunBackupProgram(int argc, char** argv) {
  CLI::App app("Lists, verifies and restores backups without a server.", "graspdb-server backup");
  app.require_subcommand(1);
  BackupProgramOptions options;
  std::function<absl::Status(const BackupProgramOptions&)> action;
  AddBackupCommand(app, "list", "List the backups of a folder", &options, false)->callback([&] {
    action = ListAll;
  });
  AddBackupCommand(app, "verify", "Read every byte of a backup", &options, true)->callback([&] {
    action = VerifyOne;
  });
  CLI::App* restore =
      AddBackupCommand(app, "restore", "Restore a backup to an empty folder", &options, true);
  restore->add_option("--to", options.to, "Directory of the database to make")->required();
  restore->add_flag("--dry-run", options.dry_run, "Print what would change, and change nothing");
  restore->callback([&] { action = RestoreOne; });
  if (const auto end = ParseArguments(app, argc - 1, argv + 1)) return *end;
  const absl::Status status = action(options);
  if (status.ok()) return 0;
  std::fprintf(stderr, "graspdb-server: %s\n",
               PrintableText(std::string(status.message())).c_str());
  return 1;
}

}  // namespace graspdb::server
