// Findings of `graspdb doctor` about a server.
#include <gmock/gmock.h>
#include <google/protobuf/util/time_util.h>

#include <cstdint>
#include <string>

#include "client/cli/objects/doctor_checks.h"

namespace graspdb::client {
namespace {

using google::protobuf::util::TimeUtil;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kHourS = 3600;
constexpr std::int64_t kGib = 1'073'741'824;
constexpr absl::Time kNow = absl::FromUnixSeconds(1'800'000'000);

auto IsFinding(Severity severity, const std::string& words) {
  return AllOf(Field("severity", &Finding::severity, severity),
               Field("text", &Finding::text, HasSubstr(words)));
}

// With a backup of an hour ago, of a daily schedule.
v1::CatalogStatus SoundStatus() {
  v1::CatalogStatus status;
  status.set_view_count(10);
  status.set_uptime_s(10 * kHourS);
  status.set_catalog_revision(7);
  v1::BackupStatus* backup = status.mutable_backup();
  backup->set_interval_s(24 * kHourS);
  backup->mutable_last_good_backup()->set_name("backups/1");
  backup->set_last_good_age_s(kHourS);
  v1::ServerState* state = status.mutable_server_state();
  *state->mutable_time() = TimeUtil::SecondsToTimestamp(absl::ToUnixSeconds(kNow));
  state->set_index_revision(7);
  state->set_serving(true);
  state->set_database_byte_count(5 * kGib);
  for (v1::DiskSpace* disk : {state->mutable_database_disk(), backup->mutable_disk()}) {
    disk->set_byte_count(100 * kGib);
    disk->set_available_byte_count(50 * kGib);
  }
  return status;
}

Findings BackupFindings(const v1::CatalogStatus& status) {
  Findings out;
  CheckBackups(status, &out);
  return out;
}

Findings CertificateFindings(absl::Duration left) {
  Findings out;
  CheckCertificate("server", "--tls-cert", kNow + left, kNow, &out);
  return out;
}

TEST(DoctorServerChecks, NothingIsWrongWithASoundServer) {
  const v1::CatalogStatus status = SoundStatus();
  Findings out;
  CheckBackups(status, &out);
  CheckDisks(status, &out);
  CheckFiles(status.server_state(), &out);
  CheckClock(status.server_state(), kNow, kNow, &out);
  CheckIndex(status, status, &out);
  CheckCertificate("server", "--tls-cert", kNow + absl::Hours(31 * 24), kNow, &out);
  EXPECT_THAT(out, IsEmpty());
}

TEST(DoctorServerChecks, BackupsThatFailOrAreMissing) {
  v1::CatalogStatus status = SoundStatus();
  status.mutable_backup()->clear_last_good_backup();
  EXPECT_THAT(BackupFindings(status), ElementsAre(IsFinding(Severity::kWarning, "no good backup")));
  status.mutable_backup()->set_last_error("there is no folder gone for backups");
  EXPECT_THAT(BackupFindings(status),
              ElementsAre(IsFinding(Severity::kWarning, "there is no folder gone"),
                          IsFinding(Severity::kWarning, "no good backup")));
  status.mutable_backup()->clear_last_error();
  status.mutable_backup()->clear_interval_s();
  EXPECT_THAT(BackupFindings(status), ElementsAre(IsFinding(Severity::kWarning, "no good backup")));
  status.clear_backup();
  EXPECT_THAT(BackupFindings(status), ElementsAre(IsFinding(Severity::kAdvice, "--backup-dir")));
}

TEST(DoctorServerChecks, TheFirstScheduledBackupTakesItsTime) {
  v1::CatalogStatus status = SoundStatus();
  status.mutable_backup()->clear_last_good_backup();
  status.set_uptime_s(60);
  EXPECT_THAT(BackupFindings(status), IsEmpty());
}

TEST(DoctorServerChecks, BackupsThatAreOld) {
  v1::CatalogStatus status = SoundStatus();
  status.mutable_backup()->set_last_good_age_s(49 * kHourS);
  EXPECT_THAT(BackupFindings(status),
              ElementsAre(IsFinding(Severity::kWarning, "scheduled every 24.0 h")));
  status.mutable_backup()->clear_interval_s();
  EXPECT_THAT(BackupFindings(status), IsEmpty());
  status.mutable_backup()->set_last_good_age_s(8 * 24 * kHourS);
  EXPECT_THAT(BackupFindings(status),
              ElementsAre(IsFinding(Severity::kWarning, "none is scheduled")));
}

TEST(DoctorServerChecks, DisksThatAreNearlyFull) {
  v1::CatalogStatus status = SoundStatus();
  status.mutable_server_state()->mutable_database_disk()->set_available_byte_count(9 * kGib);
  status.mutable_backup()->mutable_disk()->set_available_byte_count(9 * kGib);
  Findings out;
  CheckDisks(status, &out);
  EXPECT_THAT(out, ElementsAre(IsFinding(Severity::kWarning, "the disk of its database"),
                               IsFinding(Severity::kWarning, "the disk of its backups")));
}

TEST(DoctorServerChecks, ADiskWithoutSpaceForTheDatabaseAgain) {
  v1::CatalogStatus status = SoundStatus();
  status.mutable_server_state()->set_database_byte_count(51 * kGib);
  status.mutable_backup()->clear_disk();
  Findings out;
  CheckDisks(status, &out);
  EXPECT_THAT(out, ElementsAre(IsFinding(Severity::kWarning, "the database has 51.0 GiB")));
}

TEST(DoctorServerChecks, ChangesThatAreRejected) {
  v1::ServerState state;
  Findings out;
  CheckWrites(state, &out);
  EXPECT_THAT(out, IsEmpty());
  state.mutable_write_fault()->set_error("cannot write the change: Read-only file system");
  CheckWrites(state, &out);
  EXPECT_THAT(out, ElementsAre(IsFinding(Severity::kError, "Read-only file system")));
  state.mutable_write_fault()->set_error("cannot write \x1b[2J");
  CheckWrites(state, &out);
  EXPECT_EQ(out.back().text.find('\x1b'), std::string::npos) << out.back().text;
}

TEST(DoctorServerChecks, DamagedFilesOfTheDatabase) {
  v1::ServerState state;
  v1::DamagedFile* file = state.add_damaged_files();
  file->set_name("000012.blob");
  file->set_error("No such file or \x1b[2Jdirectory");
  *state.add_damaged_files() = *file;
  file->set_backup("backups/7");
  Findings out;
  CheckDatabaseFiles(state, &out);
  EXPECT_THAT(out, ElementsAre(IsFinding(Severity::kError, "backups/7 has it"),
                               IsFinding(Severity::kError, "no backup of this catalogue has it")));
  EXPECT_THAT(out.front().text,
              HasSubstr("000012.blob is damaged (No such file or ?[2Jdirectory)"));
}

TEST(DoctorServerChecks, FilesThatCannotBeUsed) {
  v1::ServerState state;
  v1::FileFault* fault = state.add_file_faults();
  fault->set_flag("--identities");
  fault->set_error("--identities i.jsonl: line 3: roles are missing");
  fault = state.add_file_faults();
  fault->set_flag("--tls-cert");
  fault->set_error("--tls-key k.pem is not the key of --tls-cert c.pem");
  Findings out;
  CheckFiles(state, &out);
  EXPECT_THAT(out, ElementsAre(IsFinding(Severity::kError, "revocations in the file have no"),
                               IsFinding(Severity::kError, "is not the key of")));
  EXPECT_THAT(out.front().text, HasSubstr("line 3"));
}

TEST(DoctorServerChecks, LostAuditRecordsAreReportedAfterTheFault) {
  v1::ServerState state;
  state.set_lost_audit_record_count(1);
  Findings out;
  CheckFiles(state, &out);
  EXPECT_THAT(out, ElementsAre(IsFinding(Severity::kWarning, "lost 1 audit record ")));
  v1::FileFault* fault = state.add_file_faults();
  fault->set_flag("--audit-log");
  fault->set_error("cannot write --audit-log a.jsonl (No space left on device)");
  out.clear();
  CheckFiles(state, &out);
  EXPECT_THAT(out, ElementsAre(IsFinding(Severity::kError, "No space left on device")));
}

TEST(DoctorServerChecks, CertificatesThatExpire) {
  EXPECT_THAT(CertificateFindings(absl::Hours(20 * 24)),
              ElementsAre(IsFinding(Severity::kAdvice, "--tls-cert) expires on ")));
  EXPECT_THAT(CertificateFindings(absl::Hours(13 * 24)),
              ElementsAre(IsFinding(Severity::kWarning, "renew it")));
  EXPECT_THAT(CertificateFindings(-absl::Seconds(1)),
              ElementsAre(IsFinding(Severity::kError, "expired on ")));
  // The time's distance from UTC, as logs are in UTC.
  EXPECT_THAT(CertificateFindings(-absl::Seconds(1)).at(0).text,
              ::testing::ContainsRegex("expired on [0-9-]+ [0-9:]+ [+-][0-9][0-9]:[0-9][0-9]"));
}

TEST(DoctorServerChecks, ClocksThatDiffer) {
  const v1::ServerState state = SoundStatus().server_state();
  Findings out;
  CheckClock(state, kNow - absl::Minutes(3), kNow - absl::Seconds(59), &out);  // a slow call
  EXPECT_THAT(out, IsEmpty());
  CheckClock(state, kNow - absl::Minutes(3), kNow - absl::Minutes(2), &out);
  CheckClock(state, kNow + absl::Minutes(5), kNow + absl::Minutes(6), &out);
  EXPECT_THAT(out, ElementsAre(IsFinding(Severity::kWarning, "120 s ahead of"),
                               IsFinding(Severity::kWarning, "300 s behind")));
}

TEST(DoctorServerChecks, AnIndexThatLacksChanges) {
  const v1::CatalogStatus first = SoundStatus();
  v1::CatalogStatus later = first;
  later.set_catalog_revision(8);  // a change of this moment
  Findings out;
  CheckIndex(first, later, &out);
  EXPECT_THAT(out, IsEmpty());
  later.mutable_server_state()->set_index_revision(6);
  CheckIndex(first, later, &out);
  later.mutable_server_state()->set_serving(false);
  CheckIndex(first, later, &out);
  EXPECT_THAT(out, ElementsAre(IsFinding(Severity::kWarning, "has revision 6, but the catalogue 7"),
                               IsFinding(Severity::kError, "an old catalogue")));
}

}  // namespace
}  // namespace graspdb::client
