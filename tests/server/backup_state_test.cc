// The state of the backups in CatalogStatus, and the folder that they are in.
#include <gmock/gmock.h>

#include "tests/server/backup_service_fixture.h"

namespace graspdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST_F(BackupServiceTest, StatusHasTheLastGoodBackupAndTheLastError) {
  EXPECT_FALSE(Status().backup().has_last_good_backup());
  Create();
  ASSERT_THAT(CreateObject("mug"), IsGrpcOk());
  const v1::Backup second = Create();
  v1::BackupStatus state = Status().backup();
  EXPECT_EQ(state.backup_count(), 2);
  EXPECT_EQ(state.last_good_backup().SerializeAsString(), second.SerializeAsString());
  EXPECT_GE(state.last_good_age_s(), 0);
  EXPECT_EQ(state.last_error(), "");

  Damage(2);
  const grpc::Status damaged = Verify("backups/2");
  EXPECT_EQ(damaged.error_code(), grpc::StatusCode::DATA_LOSS);
  EXPECT_THAT(damaged.error_message(), HasSubstr("private/2/"));
  state = Status().backup();
  EXPECT_EQ(state.backup_count(), 1);
  EXPECT_EQ(state.last_good_backup().name(), "backups/1");
  EXPECT_THAT(state.last_error(), HasSubstr("backup 2 in "));
  EXPECT_GT(state.last_error_time().seconds(), 1'700'000'000);

  Create();
  state = Status().backup();
  EXPECT_EQ(state.last_good_backup().name(), "backups/3");
  EXPECT_EQ(state.last_error(), "");
}

TEST_F(BackupServiceTest, StatusHasTheDiskOfTheFolder) {
  const v1::DiskSpace disk = Status().backup().disk();
  EXPECT_GT(disk.available_byte_count(), 0);
  EXPECT_GE(disk.byte_count(), disk.available_byte_count());
  options_.backup_dir += ".gone";
  Restart();
  EXPECT_TRUE(Status().has_backup());
  EXPECT_FALSE(Status().backup().has_disk());
}

TEST_F(BackupServiceTest, ABackupWithTheNumberOfADeletedDamagedOneIsGood) {
  Create();
  Create();
  Damage(2);
  ASSERT_EQ(Verify("backups/2").error_code(), grpc::StatusCode::DATA_LOSS);
  ASSERT_THAT(Delete("backups/2"), IsGrpcOk());
  ASSERT_EQ(Create().name(), "backups/2");
  EXPECT_EQ(Status().backup().last_good_backup().name(), "backups/2");
  EXPECT_EQ(Status().backup().backup_count(), 2);
}

TEST_F(BackupServiceTest, TheListHasTheDamageThatAVerificationFound) {
  Create();
  Create();
  Damage(2);
  const auto damages = [&] {
    v1::ListBackupsResponse response;
    EXPECT_THAT(Call(&BackupStub::ListBackups, v1::ListBackupsRequest(), &response), IsGrpcOk());
    std::vector<std::string> out;
    for (const v1::Backup& backup : response.backups()) out.push_back(backup.damage());
    return out;
  };
  EXPECT_THAT(damages(), ElementsAre("", "")) << "the list reads no files";
  ASSERT_EQ(Verify("backups/2").error_code(), grpc::StatusCode::DATA_LOSS);
  EXPECT_THAT(damages(), ElementsAre("", HasSubstr("private/2/")));
}

TEST_F(BackupServiceTest, ANewBackupWithADamagedFileOfAnEarlierOneDoesNotCount) {
  Teach("wedge", 2);
  Create();
  DamageFilesOf("shared_checksum");
  ASSERT_EQ(Verify("backups/1").error_code(), grpc::StatusCode::DATA_LOSS);
  v1::CreateBackupResponse response;
  ExpectError(Stream(&BackupStub::CreateBackup, v1::CreateBackupRequest(), &response),
              grpc::StatusCode::DATA_LOSS, "no backup was made");
  EXPECT_THAT(Listed(), ElementsAre("backups/1"));
  const v1::BackupStatus state = Status().backup();
  EXPECT_FALSE(state.has_last_good_backup());
  EXPECT_THAT(state.last_error(), HasSubstr("shared_checksum"));
}

TEST_F(BackupServiceTest, WithoutAFolderTheErrorNamesTheSetting) {
  options_.backup_dir = "";
  Restart();
  EXPECT_FALSE(Status().has_backup());
  v1::CreateBackupResponse ignored;
  std::vector<std::string> none;
  for (const grpc::Status& status :
       {Stream(&BackupStub::CreateBackup, v1::CreateBackupRequest(), &ignored),
        Call(&BackupStub::ListBackups, v1::ListBackupsRequest()), Verify("backups/1"),
        Delete("backups/1"), Compare("backups/1", &none)}) {
    EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
    EXPECT_THAT(status.error_message(), HasSubstr("--backup-dir"));
  }
}

TEST_F(BackupServiceTest, UnsuitableFoldersAreRejectedAtTheStart) {
  const auto start_with = [&](const std::string& folder) {
    server::ServerOptions other = options_;
    other.database = (folder_.path() / "other").string();
    other.backup_dir = folder;
    return server::Server::Start(other).status();
  };
  const auto rejected = absl::StatusCode::kFailedPrecondition;
  EXPECT_THAT(start_with(options_.backup_dir), StatusIs(rejected, HasSubstr("in use")));
  EXPECT_THAT(start_with((folder_.path() / "other").string()),
              StatusIs(rejected, HasSubstr("another disk")));
  EXPECT_THAT(start_with((folder_.path() / "other/backups").string()),
              StatusIs(rejected, HasSubstr("another disk")));
  EXPECT_THAT(start_with(folder_.path().string()), StatusIs(rejected, HasSubstr("contain")));
  std::filesystem::create_directory(folder_.path() / "documents");
  folder_.Write("documents/letter.txt", "Dear");
  EXPECT_THAT(start_with((folder_.path() / "documents").string()),
              StatusIs(rejected, HasSubstr("letter.txt")));
}

TEST_F(BackupServiceTest, AServerStartsWithoutTheDiskOfItsBackupsAndUsesItLater) {
  options_.backup_dir = (folder_.path() / "disk").string();
  Restart();
  EXPECT_THAT(Status().backup().last_error(), HasSubstr("mount its disk"));
  EXPECT_THAT(CreateObject("mug"), IsGrpcOk());
  EXPECT_EQ(Verify("backups/1").error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(Call(&BackupStub::ListBackups, v1::ListBackupsRequest()).error_code(),
            grpc::StatusCode::UNAVAILABLE);
  std::filesystem::create_directory(options_.backup_dir);
  EXPECT_EQ(Create().object_count(), 1);
  EXPECT_EQ(Status().backup().last_error(), "");
}

}  // namespace
}  // namespace graspdb::testing
