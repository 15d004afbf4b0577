// The audit log of a server.
#include <gmock/gmock.h>

#include <filesystem>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "program/log/request_id.h"
#include "server/access/audit_log.h"
#include "tests/files/temporary_folder.h"
#include "tests/server/access_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

class AuditTest : public AccessTest {};

TEST_F(AuditTest, ChangesAreRecordedWithCallerResourceAndRevision) {
  token_ = Add("teacher", {v1::ROLE_TEACH, v1::ROLE_READ});
  const std::size_t before = Audited().size();
  Declare("flange");
  ASSERT_THAT(Upload({ViewOf("flange", 0, "a")}), IsGrpcOk());
  v1::DeleteObjectRequest deletion;
  deletion.set_name("objects/flange");
  EXPECT_FALSE(Call(&Catalog::DeleteObject, deletion).ok());  // it has a stable pose
  std::vector<v1::AuditRecord> records = Audited();
  records.erase(records.begin(), records.begin() + static_cast<std::ptrdiff_t>(before));
  ASSERT_THAT(records, SizeIs(4));
  std::vector<std::string> methods;
  std::vector<std::string> codes;
  for (const v1::AuditRecord& record : records) {
    EXPECT_EQ(record.identity(), "teacher");
    EXPECT_EQ(record.peer(), "unknown");  // in this process
    EXPECT_LT(std::abs(record.time().seconds() - absl::ToUnixSeconds(absl::Now())), 600);
    methods.push_back(record.method());
    codes.push_back(record.code());
  }
  EXPECT_THAT(methods, ElementsAre("graspdb.v1.CatalogService.CreateObject",
                                   "graspdb.v1.CatalogService.CreateStablePose",
                                   "graspdb.v1.CatalogService.UploadViews",
                                   "graspdb.v1.CatalogService.DeleteObject"));
  EXPECT_THAT(codes, ElementsAre("OK", "OK", "OK", "FAILED_PRECONDITION"));
  EXPECT_THAT(records[0].resources(), ElementsAre("objects/flange"));
  EXPECT_THAT(records[1].resources(), ElementsAre("objects/flange/stablePoses/flat"));
  EXPECT_THAT(records[2].resources(), ElementsAre("objects/flange/stablePoses/flat"));
  EXPECT_EQ(records[0].catalog_revision() + 2, records[2].catalog_revision());
  EXPECT_EQ(records[2].catalog_revision(), Status().catalog_revision());
  EXPECT_THAT(records[3].error(), HasSubstr("force"));
}

TEST_F(AuditTest, TheRecordOfANewBackupHasItsName) {
  options_.backup_dir = (folder_.path() / "backups").string();
  std::filesystem::create_directory(options_.backup_dir);
  Restart();
  grpc::ClientContext context;
  context.AddMetadata("authorization", "Bearer " + token_);
  const auto reader = StubOf<BackupStub>().CreateBackup(&context, v1::CreateBackupRequest());
  for (v1::CreateBackupResponse message; reader->Read(&message);) continue;
  ASSERT_THAT(reader->Finish(), IsGrpcOk());
  EXPECT_THAT(Audited().back().resources(), ElementsAre("backups/1"));
}

TEST_F(AuditTest, ReadsAreNotRecordedButTheirRefusalsAre) {
  EXPECT_THAT(StatusAs(token_), IsGrpcOk());
  EXPECT_THAT(Audited(), IsEmpty());
  EXPECT_FALSE(StatusAs("graspdb_wrong").ok());
  const std::vector<v1::AuditRecord> records = Audited();
  ASSERT_THAT(records, SizeIs(1));
  EXPECT_EQ(records[0].code(), "UNAUTHENTICATED");
  EXPECT_EQ(records[0].identity(), "");
  EXPECT_EQ(records[0].method(), "graspdb.v1.CatalogService.GetCatalogStatus");
}

TEST_F(AuditTest, TimesHaveMilliseconds) {
  bool has_fraction = false;
  // One call may be made at a whole second; a hundred take longer than its first millisecond.
  for (int i = 0; i < 100 && !has_fraction; ++i) {
    EXPECT_FALSE(StatusAs("graspdb_wrong").ok());
    has_fraction = Audited().back().time().nanos() != 0;
  }
  EXPECT_TRUE(has_fraction);
}

TEST_F(AuditTest, TheOutcomesOfGraspsAreRecorded) {
  Declare("flange");
  const std::size_t before = Audited().size();
  v1::ReportGraspOutcomeRequest report;
  report.set_name(FlatPoseOf("flange"));
  report.set_grasp_id(Part("flange").grasps.front().grasp_id());
  report.set_outcome(v1::GRASP_OUTCOME_PICKED);
  EXPECT_THAT(Call(&Catalog::ReportGraspOutcome, report), IsGrpcOk());
  ASSERT_EQ(Audited().size(), before + 1);
  EXPECT_THAT(Audited().back().resources(), ElementsAre(FlatPoseOf("flange")));
}

TEST_F(AuditTest, ARecordHasTheIdOfItsCallAsTheLogHas) {
  grpc::ClientContext context;
  context.AddMetadata("authorization", "Bearer " + token_);
  context.AddMetadata(kRequestIdKey, "job-17.3");
  v1::CreateObjectRequest request;
  request.set_object_id("mug");
  v1::Object mug;
  ASSERT_THAT(StubOf<Catalog>().CreateObject(&context, request, &mug), IsGrpcOk());
  EXPECT_EQ(Audited().back().request_id(), "job-17.3");
  ASSERT_THAT(CreateObject("box"), IsGrpcOk());
  const std::string made = Audited().back().request_id();
  EXPECT_TRUE(IsRequestId(made)) << made;
}

TEST_F(AuditTest, TextOfCallersIsEscapedAndBounded) {
  v1::DeleteObjectRequest deletion;
  deletion.set_name("objects/x\"}\n{\"identity\":\"forged\xe2\x80\xa8" + std::string(100'000, 'y'));
  EXPECT_FALSE(Call(&Catalog::DeleteObject, deletion).ok());
  const std::string text = audit_text();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_LT(text.size(), 2000U);
  ASSERT_THAT(Audited(), SizeIs(1));
  EXPECT_EQ(Audited()[0].identity(), "admin");
  EXPECT_THAT(Audited()[0].resources(0), AllOf(StartsWith("objects/x\"}\n{"), EndsWith("...")));
  EXPECT_EQ(Audited()[0].resources(0).size(), 256U);
}

TEST_F(AuditTest, TokensAreNotInIt) {
  const std::string reader = Add("reader", {v1::ROLE_READ});
  token_ = reader;
  EXPECT_FALSE(CreateObject("mug").ok());
  token_ = "graspdb_of-another-server";
  EXPECT_FALSE(CreateObject("mug").ok());
  EXPECT_THAT(audit_text(), AllOf(HasSubstr("PERMISSION_DENIED"), Not(HasSubstr(reader)),
                                  Not(HasSubstr("of-another-server"))));
}

TEST_F(AuditTest, WithoutIdentitiesChangesAreRecordedToo) {
  options_.identities.clear();
  token_.clear();
  Restart();
  EXPECT_THAT(CreateObject("mug"), IsGrpcOk());
  ASSERT_THAT(Audited(), SizeIs(1));
  EXPECT_EQ(Audited()[0].identity(), "");
}

TEST(AuditLogTest, FullFilesAreRenamed) {
  const files::TemporaryFolder folder;
  const std::string path = folder.path() / "audit.jsonl";
  auto log = server::AuditLog::Open(path, 1000);
  ASSERT_THAT(log, IsOk());
  v1::AuditRecord record;
  record.set_error(std::string(300, 'x'));
  for (int i = 0; i < 50; ++i) (*log)->Write(record);
  std::vector<std::string> files;
  for (const auto& file : std::filesystem::directory_iterator(folder.path())) {
    EXPECT_LE(file.file_size(), 1000U);
    files.push_back(file.path().filename());
  }
  EXPECT_THAT(files, SizeIs(11));
  EXPECT_THAT(files, ::testing::IsSupersetOf({"audit.jsonl", "audit.1.jsonl", "audit.10.jsonl"}));
}

TEST(AuditLogTest, AFullFileThatCannotBeRenamedLosesNoLine) {
  const files::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "audit.jsonl";
  for (int i = 1; i < 10; ++i) folder.Write(absl::StrCat("audit.", i, ".jsonl"), "old\n");
  const std::filesystem::path obstacle = folder.path() / "audit.10.jsonl";
  std::filesystem::create_directories(obstacle / "not empty");
  auto log = server::AuditLog::Open(path.string(), 1000);
  ASSERT_THAT(log, IsOk());
  v1::AuditRecord record;
  record.set_error(std::string(300, 'x'));
  for (int i = 0; i < 10; ++i) (*log)->Write(record);
  const std::string text = files::BytesOf(path);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 10);
  EXPECT_EQ(files::BytesOf(folder.path() / "audit.1.jsonl"), "old\n");
  std::filesystem::remove_all(obstacle);
  const auto newest_full = [&] { return files::BytesOf(folder.path() / "audit.1.jsonl"); };
  for (int i = 0; i < 10 && newest_full() == "old\n"; ++i) (*log)->Write(record);
  EXPECT_THAT(newest_full(), StartsWith(text));
}

TEST(AuditLogTest, AFileThatCannotBeOpenedIsAnError) {
  EXPECT_THAT(server::AuditLog::Open("/proc/none/audit.jsonl", 1000),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("--audit-log")));
}

}  // namespace
}  // namespace graspdb::testing
