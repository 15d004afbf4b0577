// The state of the backups in CatalogStatus, and the folder that they are in.
#include <gmock/gmock.h>

#include <random>

#include "tests/server/backup_service_fixture.h"

namespace graspdb::testing {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

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

// Of so many points that the database keeps them in a file of clouds.
v1::UploadViewsRequest LargeView() {
  const Frame frame = Photograph("wedge", {}, 7);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> across(-0.1F, 0.1F);
  std::uniform_real_distribution<float> height(0.0F, 0.1F);
  recognition::Points points;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d p(across(random), across(random), height(random));
    points.push_back((frame.world_sensor.inverse() * p).cast<float>());
  }
  v1::UploadViewsRequest out = ViewOf("wedge", 0, "large");
  *out.mutable_view()->mutable_cloud() = PackedCloud(points);
  out.mutable_view()->set_segmented(true);
  return out;
}

// Not the sorted files: RocksDB compacts some when a snapshot is released, and writes lost ones
// again from what it has open.
TEST_F(BackupServiceTest, ADamagedFileIsInTheNewestGoodBackupThatHasIt) {
  Declare("wedge");
  ASSERT_THAT(Upload(LargeView()), IsGrpcOk());
  Create();
  std::vector<std::filesystem::path> shared;
  for (const auto& entry : std::filesystem::directory_iterator(options_.database)) {
    if (entry.path().extension() == ".blob") shared.push_back(entry.path());
  }
  ASSERT_THAT(CreateObject("mug"), IsGrpcOk());
  Create();
  for (const auto& file : shared) std::filesystem::remove(file);
  const auto backups = [&] {
    std::vector<std::string> out;
    const v1::CatalogStatus status = Status();
    for (const v1::DamagedFile& file : status.server_state().damaged_files()) {
      out.push_back(file.backup());
    }
    return out;
  };
  EXPECT_THAT(backups(), AllOf(Not(IsEmpty()), Each("backups/2")));
  Damage(2);
  ASSERT_EQ(Verify("backups/2").error_code(), grpc::StatusCode::DATA_LOSS);
  EXPECT_THAT(backups(), AllOf(Not(IsEmpty()), Each("backups/1")));
  Damage(1);
  ASSERT_EQ(Verify("backups/1").error_code(), grpc::StatusCode::DATA_LOSS);
  EXPECT_THAT(backups(), AllOf(Not(IsEmpty()), Each("")));
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

// The backup that a repeated call gets was made by the first one.
TEST_F(BackupServiceTest, ARepeatedCallDeletesNoBackup) {
  Teach("wedge", 2);
  v1::CreateBackupRequest request;
  request.set_request_id("123e4567-e89b-42d3-a456-426614174000");
  v1::CreateBackupResponse response;
  ASSERT_THAT(Stream(&BackupStub::CreateBackup, request, &response), IsGrpcOk());
  DamageFilesOf("shared_checksum");
  ASSERT_EQ(Verify("backups/1").error_code(), grpc::StatusCode::DATA_LOSS);
  ASSERT_THAT(Stream(&BackupStub::CreateBackup, request, &response), IsGrpcOk());
  EXPECT_EQ(response.backup().name(), "backups/1");
  EXPECT_THAT(Listed(), ElementsAre("backups/1"));
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

TEST_F(BackupServiceTest, StatusHasTheErrorOfAVerificationWithoutTheDisk) {
  Create();
  const std::filesystem::path away = folder_.path() / "away";
  std::filesystem::rename(options_.backup_dir, away);
  EXPECT_EQ(Verify("backups/1").error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_THAT(Status().backup().last_error(), HasSubstr("mount its disk"));
  std::filesystem::rename(away, options_.backup_dir);
}

}  // namespace
}  // namespace graspdb::testing
