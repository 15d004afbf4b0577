// Calls of BackupService.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "tests/server/backup_service_fixture.h"

namespace graspdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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

}  // namespace
}  // namespace graspdb::testing
