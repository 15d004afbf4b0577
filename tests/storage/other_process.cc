// The other process of the tests: opens the catalogue in argv[2] and
//   open     keeps it open until its standard input ends,
//   write    stores views until it is killed,
//   undelete deletes the object with its views, brings it back and purges its history until it is
//            killed,
//   report   reports outcomes of a grasp, each with an id, until it is killed,
//   backup   makes backups of it in the folder argv[3] until it is killed,
//   restore  restores backup 1 of argv[3] to argv[2].
// Writes every acknowledged revision to its standard output, eight bytes each; the first
// one after opening. Of backups it writes their numbers, and for a restore the bytes read. A
// program of its own, because the threads that RocksDB keeps in a test program do not survive a
// fork.
#include "tests/storage/other_process.h"

#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>

#include "storage/backups/backups.h"
#include "storage/catalogue/catalogue.h"
#include "storage/history/history.h"

namespace graspdb::storage {
namespace {

bool Report(std::int64_t revision) {
  return write(STDOUT_FILENO, &revision, sizeof(revision)) == sizeof(revision);
}

// In two changes, in an empty catalogue.
absl::Status MakeStablePose(Catalogue& catalogue) {
  if (catalogue.revision() > 0) return absl::OkStatus();
  v1::Object object;
  object.set_name("objects/mug");
  v1::StablePose pose;
  pose.set_name("objects/mug/stablePoses/upright");
  pose.add_grasps()->set_grasp_id("top");
  if (auto made = catalogue.CreateObject(object); !made.ok()) return made.status();
  return catalogue.CreateStablePose(pose).status();
}

absl::Status ReportUntilKilled(Catalogue& catalogue) {
  if (auto made = MakeStablePose(catalogue); !made.ok()) return made;
  v1::GraspOutcomeCounts missed;
  missed.set_grasp_id("top");
  missed.set_missed_count(1);
  for (std::int64_t i = catalogue.revision() - 2;; ++i) {
    const auto added = catalogue.AddGraspOutcomes("objects/mug/stablePoses/upright", missed,
                                                  {WrittenRequestId(i), "x"});
    if (!added.ok()) return added.status();
    if (!Report(added->revision)) return absl::CancelledError("the output is closed");
  }
}

absl::Status WriteUntilKilled(Catalogue& catalogue) {
  if (auto made = MakeStablePose(catalogue); !made.ok()) return made;
  for (std::int64_t i = catalogue.counts().views;; ++i) {
    NewView view;
    view.record.set_name(WrittenViewName(i));
    view.record.set_content_digest(std::to_string(i));
    view.packed_cloud = WrittenCloud(i);
    if (auto stored = catalogue.PutView(view); !stored.ok()) return stored.status();
    if (!Report(catalogue.revision())) return absl::CancelledError("the output is closed");
  }
}

absl::Status UndeleteUntilKilled(Catalogue& catalogue) {
  for (;;) {
    const auto deleted = catalogue.history().ListDeleted(1, "");
    if (!deleted.ok()) return deleted.status();
    absl::Status changed = deleted->records.empty()
                               ? catalogue.DeleteObject("objects/mug", /*force=*/true, "")
                               : catalogue.history().Undelete("objects/mug").status();
    if (!changed.ok()) return changed;
    if (!Report(catalogue.revision())) return absl::CancelledError("the output is closed");
    if (!deleted->records.empty()) {
      changed = catalogue.history().PurgeOlderThan(absl::Now()).status();
      if (!changed.ok()) return changed;
    }
  }
}

absl::Status MakeBackupsUntilKilled(Catalogue& catalogue, const std::string& folder) {
  Backups backups(folder);
  for (;;) {
    const auto made = backups.Create(catalogue);
    if (!made.ok()) return made.status();
    if (!Report(made->id)) return absl::CancelledError("the output is closed");
  }
}

absl::Status Restore(const std::string& database, const std::string& folder) {
  BackupProgress progress;
  progress.on_bytes = [](std::int64_t bytes) { Report(bytes); };
  return Backups(folder).Restore(1, database, progress).status();
}

absl::Status Run(const std::string& what, const std::string& database, const std::string& folder) {
  if (what == "restore") return Restore(database, folder);
  CatalogueOptions options;
  options.write_buffer_bytes = 256U << 10;  // so that kills hit flushes as well
  auto catalogue = Catalogue::Open(database, std::move(options));
  if (!catalogue.ok()) return catalogue.status();
  if (!Report((*catalogue)->revision())) return absl::CancelledError("the output is closed");
  if (what == "write") return WriteUntilKilled(**catalogue);
  if (what == "undelete") return UndeleteUntilKilled(**catalogue);
  if (what == "report") return ReportUntilKilled(**catalogue);
  if (what == "backup") return MakeBackupsUntilKilled(**catalogue, folder);
  char byte = 0;
  return read(STDIN_FILENO, &byte, 1) == 0 ? absl::OkStatus() : absl::InternalError("not ended");
}

}  // namespace
}  // namespace graspdb::storage

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const absl::Status status = graspdb::storage::Run(argv[1], argv[2], argv[3]);
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.ToString().c_str());
  return status.ok() ? 0 : 1;
}
