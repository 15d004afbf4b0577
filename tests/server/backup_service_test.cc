// BackupService, and the state of the backups in CatalogStatus.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "storage/backups.h"
#include "tests/server/server_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class BackupServiceTest : public ServerTest {
 protected:
  void SetUp() override {
    options_.backup_dir = (folder_.path() / "backups").string();
    std::filesystem::create_directory(options_.backup_dir);
    ServerTest::SetUp();
  }

  // Calls a method that streams; `last` gets the last message.
  template <typename Request, typename Response>
  grpc::Status Stream(std::unique_ptr<grpc::ClientReader<Response>> (BackupStub::*method)(
                          grpc::ClientContext*, const Request&),
                      const Request& request, Response* last) {
    grpc::ClientContext context;
    const auto reader = (StubOf<BackupStub>().*method)(&context, request);
    while (reader->Read(last)) continue;
    return reader->Finish();
  }

  v1::Backup Create() {
    v1::CreateBackupResponse response;
    EXPECT_THAT(Stream(&BackupStub::CreateBackup, v1::CreateBackupRequest(), &response),
                IsGrpcOk());
    return response.backup();
  }

  grpc::Status Verify(const std::string& name, v1::VerifyBackupResponse* response) {
    v1::VerifyBackupRequest request;
    request.set_name(name);
    return Stream(&BackupStub::VerifyBackup, request, response);
  }

  grpc::Status Verify(const std::string& name) {
    v1::VerifyBackupResponse ignored;
    return Verify(name, &ignored);
  }

  grpc::Status Delete(const std::string& name) {
    v1::DeleteBackupRequest request;
    request.set_name(name);
    return Call(&BackupStub::DeleteBackup, request);
  }

  grpc::Status Compare(const std::string& name, std::vector<std::string>* names) {
    v1::CompareBackupRequest request;
    request.set_name(name);
    grpc::ClientContext context;
    const auto reader = StubOf<BackupStub>().CompareBackup(&context, request);
    v1::CompareBackupResponse response;
    while (reader->Read(&response)) {
      for (const v1::BackupDifference& difference : response.differences()) {
        names->push_back(v1::BackupDifference::Kind_Name(difference.kind()) + " " +
                         difference.name());
      }
    }
    return reader->Finish();
  }

  std::vector<std::string> Listed() {
    v1::ListBackupsResponse response;
    EXPECT_THAT(Call(&BackupStub::ListBackups, v1::ListBackupsRequest(), &response), IsGrpcOk());
    std::vector<std::string> names;
    for (const v1::Backup& backup : response.backups()) names.push_back(backup.name());
    return names;
  }

  // Changes a byte in the middle of each file of a folder of the backups.
  void DamageFilesOf(const std::string& folder) const {
    const auto path = std::filesystem::path(options_.backup_dir) / folder;
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
      const auto middle = static_cast<std::streamoff>(entry.file_size() / 2);
      file.seekg(middle);
      const int before = file.get();
      file.seekp(middle);
      file.put(static_cast<char>(~before));
    }
  }

  // Changes the files that only this backup has.
  void Damage(int id) const { DamageFilesOf("private/" + std::to_string(id)); }
};

TEST_F(BackupServiceTest, ARepeatedCallGetsItsBackup) {
  v1::CreateBackupRequest request;
  request.set_request_id("123e4567-e89b-42d3-a456-426614174000");
  v1::CreateBackupResponse first;
  ASSERT_THAT(Stream(&BackupStub::CreateBackup, request, &first), IsGrpcOk());
  EXPECT_NE(Create().name(), first.backup().name());
  request.set_request_id("123E4567-E89B-42D3-A456-426614174000");
  v1::CreateBackupResponse again;
  ASSERT_THAT(Stream(&BackupStub::CreateBackup, request, &again), IsGrpcOk());
  EXPECT_EQ(again.backup().name(), first.backup().name());
  EXPECT_EQ(Status().backup().backup_count(), 2);
  request.set_request_id("backup-7");
  ExpectError(Stream(&BackupStub::CreateBackup, request, &again),
              grpc::StatusCode::INVALID_ARGUMENT, "request_id: must be a UUID");
}

TEST_F(BackupServiceTest, MakesListsVerifiesAndDeletes) {
  EXPECT_THAT(Listed(), IsEmpty());
  Teach("wedge", 3);
  const v1::Backup first = Create();
  EXPECT_EQ(first.name(), "backups/1");
  EXPECT_EQ(first.catalog_revision(), Status().catalog_revision());
  EXPECT_EQ(first.object_count(), 1);
  EXPECT_EQ(first.stable_pose_count(), 1);
  EXPECT_EQ(first.view_count(), 3);
  EXPECT_GT(first.byte_count(), 1000);
  EXPECT_GT(first.create_time().seconds(), 1'700'000'000);
  ASSERT_THAT(CreateObject("mug"), IsGrpcOk());
  EXPECT_EQ(Create().catalog_revision(), first.catalog_revision() + 1);
  EXPECT_THAT(Listed(), ElementsAre("backups/1", "backups/2"));

  v1::VerifyBackupResponse verified;
  EXPECT_THAT(Verify("backups/1", &verified), IsGrpcOk());
  EXPECT_EQ(verified.backup().SerializeAsString(), first.SerializeAsString());
  EXPECT_GE(verified.done_byte_count(), first.byte_count());
  EXPECT_THAT(Delete("backups/1"), IsGrpcOk());
  EXPECT_THAT(Listed(), ElementsAre("backups/2"));
  Restart();
  EXPECT_THAT(Listed(), ElementsAre("backups/2"));
}

TEST_F(BackupServiceTest, ComparesWithTheCatalogue) {
  Declare("wedge");
  Create();
  std::vector<std::string> names;
  EXPECT_THAT(Compare("backups/1", &names), IsGrpcOk());
  EXPECT_THAT(names, IsEmpty());
  ASSERT_THAT(CreateObject("mug"), IsGrpcOk());
  v1::DeleteObjectRequest remove;
  remove.set_name("objects/wedge");
  remove.set_force(true);
  ASSERT_THAT(Call(&Catalog::DeleteObject, remove), IsGrpcOk());
  EXPECT_THAT(Compare("backups/1", &names), IsGrpcOk());
  EXPECT_THAT(names, ElementsAre("KIND_REMOVED objects/mug", "KIND_ADDED objects/wedge",
                                 "KIND_ADDED objects/wedge/stablePoses/flat"));
}

TEST_F(BackupServiceTest, ListsByPages) {
  for (int i = 0; i < 3; ++i) Create();
  v1::ListBackupsRequest request;
  request.set_page_size(2);
  v1::ListBackupsResponse page;
  EXPECT_THAT(Call(&BackupStub::ListBackups, request, &page), IsGrpcOk());
  ASSERT_EQ(page.backups_size(), 2);
  EXPECT_NE(page.next_page_token(), "");
  request.set_page_token(page.next_page_token());
  page.Clear();
  EXPECT_THAT(Call(&BackupStub::ListBackups, request, &page), IsGrpcOk());
  ASSERT_EQ(page.backups_size(), 1);
  EXPECT_EQ(page.backups(0).name(), "backups/3");
  EXPECT_EQ(page.next_page_token(), "");
  request.set_page_token("nonsense");
  EXPECT_EQ(Call(&BackupStub::ListBackups, request).error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(BackupServiceTest, WrongNamesAreRejectedWithTheField) {
  for (const char* name : {"", "7", "backups/", "backups/0", "backups/-1", "backups/01",
                           "backups/4294967296", "backups/../1", "objects/mug"}) {
    std::vector<std::string> none;
    for (const grpc::Status& status : {Verify(name), Delete(name), Compare(name, &none)}) {
      EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << name;
      EXPECT_THAT(status.error_message(), HasSubstr("name:"));
    }
  }
  EXPECT_EQ(Verify("backups/7").error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(Delete("backups/7").error_code(), grpc::StatusCode::NOT_FOUND);
}

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

TEST_F(BackupServiceTest, CancelledAndExpiredCallsEndTheBackup) {
  options_.backup_rate_mib = 0.05;  // many seconds for these views
  Restart();
  Teach("wedge", 12);
  for (const bool by_deadline : {false, true}) {
    grpc::ClientContext context;
    const auto deadline = std::chrono::system_clock::now() + std::chrono::milliseconds(300);
    if (by_deadline) context.set_deadline(deadline);
    const auto reader = StubOf<BackupStub>().CreateBackup(&context, v1::CreateBackupRequest());
    v1::CreateBackupResponse response;
    ASSERT_TRUE(reader->Read(&response)) << "progress";
    EXPECT_FALSE(response.has_backup());
    if (!by_deadline) context.TryCancel();
    while (reader->Read(&response)) {
    }
    EXPECT_EQ(reader->Finish().error_code(),
              by_deadline ? grpc::StatusCode::DEADLINE_EXCEEDED : grpc::StatusCode::CANCELLED);
    // Another operation is accepted when the work has ended.
    grpc::Status next = Delete("backups/1");
    while (next.error_code() == grpc::StatusCode::ABORTED) next = Delete("backups/1");
    EXPECT_EQ(next.error_code(), grpc::StatusCode::NOT_FOUND);
    EXPECT_THAT(Listed(), IsEmpty());
  }
}

TEST_F(BackupServiceTest, ShutdownEndsARunningBackup) {
  options_.backup_rate_mib = 0.05;
  Restart();
  Teach("wedge", 12);
  grpc::ClientContext context;
  const auto reader = StubOf<BackupStub>().CreateBackup(&context, v1::CreateBackupRequest());
  v1::CreateBackupResponse response;
  ASSERT_TRUE(reader->Read(&response));
  server_->Drain();
  EXPECT_FALSE(reader->Finish().ok());
  EXPECT_THAT(*storage::Backups(options_.backup_dir).List(), IsEmpty());
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
