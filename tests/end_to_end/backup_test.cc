// A backup, a killed server, and a restored database that answers as the original did.
#include <gmock/gmock.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "graspdb/v1/backup.pb.h"
#include "tests/end_to_end/fixtures/outcome_matchers.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"

namespace graspdb::end_to_end {
namespace {

using ::testing::HasSubstr;

class BackupProgramsTest : public ProgramsTest {
 protected:
  BackupProgramsTest() { std::filesystem::create_directory(Path("backups")); }

  void StartWithBackups(const std::string& database) {
    StartServer(database, {"--backup-dir", Path("backups")});
  }

  v1::Backup Created() const {
    v1::Backup backup;
    const std::string json = Succeed({"backup", "create", "--json"}).out;
    EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(json, &backup).ok()) << json;
    return backup;
  }

  std::vector<std::string> RestoreTo(const std::string& database) const {
    return {"backup", "restore", "--from", Path("backups"), "--to", Path(database)};
  }
};

TEST_F(BackupProgramsTest, DoctorReportsBackupsThatFail) {
  StartServer("db", {"--backup-dir", Path("gone"), "--backup-every", "24h"});
  const Finished doctor = Graspdb({"doctor"});
  EXPECT_THAT(doctor, EndsWith(1));
  EXPECT_THAT(doctor.out, HasSubstr("there is no folder " + Path("gone")));
  EXPECT_THAT(doctor.out, HasSubstr("has no good backup"));
}

TEST_F(BackupProgramsTest, RestoredCatalogueGivesTheSameAnswersAsTheOriginalAtThatRevision) {
  StartWithBackups("db");
  Simulate("set", 30, 6);
  Succeed({"import", Path("set")});
  Succeed({"cells", "set", "press", "--sensor-pose", "0,-0.5,0.6,-0.8,0,0,0.6"});
  const std::string answers = Recognize("set");
  ASSERT_EQ(CountRight(answers), 6);
  const v1::Backup backup = Created();
  EXPECT_EQ(backup.catalog_revision(), Status().catalog_revision());
  const std::string original = Status().catalog_id();

  Succeed({"objects", "delete", "flange", "--force"});
  Succeed({"simulate", "--parts", "wedge", "--step", "60", "--out", Path("more")});
  Succeed({"import", Path("more")});
  EXPECT_NE(Recognize("set"), answers);
  const std::string difference = Succeed({"backup", "diff"}).out;
  EXPECT_THAT(difference, HasSubstr("+ objects/flange\n"));
  EXPECT_THAT(difference, HasSubstr("- objects/wedge\n"));
  server_->Signal(SIGKILL);
  server_->Wait();

  Succeed(RestoreTo("restored"));
  StartWithBackups("restored");
  EXPECT_EQ(Status().catalog_revision(), backup.catalog_revision());
  EXPECT_EQ(Recognize("set"), answers);
  EXPECT_NE(Status().catalog_id(), original);
  const Finished watched = Graspdb({"watch", "--after", "0", "--catalog-id", original});
  EXPECT_THAT(watched, EndsWith(1));
  EXPECT_THAT(watched.err, HasSubstr("read all records anew"));
  EXPECT_THAT(Succeed({"backup", "diff"}).out, HasSubstr("would add 0 records"));
  EXPECT_EQ(Created().name(), "backups/2") << "into the same folder";
}

TEST_F(BackupProgramsTest, ScheduledBackupsAreMadeAndShownInTheStatus) {
  StartServer("db", {"--backup-dir", Path("backups"), "--backup-every", "1h"});
  while (!Status().backup().has_last_good_backup() && !HasFailure()) {
  }
  EXPECT_THAT(Succeed({"status"}).out, HasSubstr("backups     1, the last good one 0.0 h old"));
  EXPECT_THAT(Succeed({"backup", "list"}).out, HasSubstr("backups/1"));
  server_->Signal(SIGTERM);
  EXPECT_THAT(server_->Wait().err, HasSubstr("event=backup id=1 revision=0"));
  EXPECT_THAT(Succeed({"backup", "list", "--from", Path("backups")}).out, HasSubstr("backup 1 of"));
}

TEST_F(BackupProgramsTest, DamagedBackupsAreNamedAndNotRestored) {
  StartWithBackups("db");
  Simulate("set", 90, 1);
  Succeed({"import", Path("set")});
  Created();
  Succeed({"backup", "verify", "1"});
  Succeed({"backup", "verify", "backups/1"});  // as the list prints it
  Succeed({"backup", "verify", "--from", Path("backups"), "--json"});
  for (const char* id : {"1", "backups/1"}) {
    EXPECT_THAT(RunProgram(folder_.path(), {GRASPDB_SERVER_PROGRAM, "backup", "verify", "--from",
                                            Path("backups"), "--id", id}),
                EndsWith(0));
  }
  std::filesystem::path file;
  for (const auto& entry : std::filesystem::directory_iterator(Path("backups/shared_checksum"))) {
    file = entry.path();
  }
  std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(10).put('\0').put('\1');
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"backup", "verify", "1"},
        std::vector<std::string>{"backup", "verify", "--from", Path("backups")},
        RestoreTo("restored")}) {
    const Finished failed = Graspdb(words);
    EXPECT_THAT(failed, EndsWith(1));
    EXPECT_THAT(failed.err, HasSubstr(file.filename().string()));
  }
  EXPECT_FALSE(std::filesystem::exists(Path("restored")));
  EXPECT_THAT(Succeed({"status"}).out, HasSubstr("failed: backup 1 in"));
  EXPECT_THAT(Succeed({"backup", "list"}).out, HasSubstr("backup 1 in"));
  Succeed({"backup", "delete", "backups/1"});
  EXPECT_THAT(Succeed({"backup", "list"}).out, HasSubstr("there are no backups"));
}

TEST_F(BackupProgramsTest, DryRunPrintsTheDifferenceToAnExistingDatabaseAndChangesNothing) {
  StartWithBackups("db");
  Simulate("set", 90, 1);
  Succeed({"import", Path("set")});
  Created();
  Succeed({"objects", "delete", "handle", "--force"});
  server_->Signal(SIGTERM);
  server_->Wait();
  std::vector<std::string> words = RestoreTo("db");
  EXPECT_THAT(Graspdb(words).err, HasSubstr("is not empty"));
  words.emplace_back("--dry-run");
  const std::string shown = Succeed(words).out;
  EXPECT_THAT(shown, HasSubstr("+ objects/handle\n"));
  EXPECT_THAT(shown, HasSubstr("would add 6 records, change 0 and remove 0"));
  words = RestoreTo("new");
  words.insert(words.end(), {"--dry-run", "--id", "1"});
  EXPECT_THAT(Succeed(words).out, HasSubstr("would restore backup 1 of"));
  EXPECT_FALSE(std::filesystem::exists(Path("new")));
  words.back() = "7";
  EXPECT_THAT(Graspdb(words).err, HasSubstr("there is no backup 7"));
  EXPECT_THAT(Graspdb({"backup", "restore", "--to", Path("new")}), EndsWith(2));

  folder_.Write("file", "");
  words = RestoreTo("file");
  for (const bool dry_run : {false, true}) {
    if (dry_run) words.emplace_back("--dry-run");
    const Finished refused = Graspdb(words);
    EXPECT_THAT(refused, EndsWith(1));
    EXPECT_THAT(refused, PrintsOnly("graspdb-server", "is not a folder"));
  }
}

}  // namespace
}  // namespace graspdb::end_to_end
