#include "server/status/server_state.h"

#include <google/protobuf/util/time_util.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "program/tls/pem_files.h"
#include "server/base/errors.h"

namespace graspdb::server {
namespace {

google::protobuf::Timestamp TimestampOf(absl::Time time) {
  return google::protobuf::util::TimeUtil::NanosecondsToTimestamp(absl::ToUnixNanos(time));
}

void AddFault(const std::optional<FileFault>& fault, v1::ServerState* state) {
  if (!fault) return;
  v1::FileFault* out = state->add_file_faults();
  out->set_flag(fault->flag);
  out->set_error(BoundedText(fault->error, kMaxMessageBytes));
  *out->mutable_time() = TimestampOf(fault->begin);
}

void SetFiles(const ServerStateSources& from, v1::ServerState* state) {
  if (!from.certificate.empty()) {
    const auto end = CertificateEnd({"--tls-cert", from.certificate});
    if (end.ok()) *state->mutable_certificate_expire_time() = TimestampOf(*end);
  }
  if (from.access.identities != nullptr) AddFault(from.access.identities->fault(), state);
  AddFault(from.tls_files.fault(), state);
  if (from.access.audit == nullptr) return;
  AddFault(from.access.audit->fault(), state);
  state->set_lost_audit_record_count(from.access.audit->lost_count());
}

void SetDamage(const ServerStateSources& from, v1::ServerState* state) {
  const std::vector<storage::DamagedFile> files = from.catalogue.damaged_files();
  std::map<std::string, storage::BackupId> backups;
  if (from.backups != nullptr && !files.empty()) {
    std::vector<std::string> names;
    names.reserve(files.size());
    for (const storage::DamagedFile& file : files) names.push_back(file.name);
    backups = from.backups->NewestWith(names);
  }
  for (const storage::DamagedFile& file : files) {
    v1::DamagedFile* out = state->add_damaged_files();
    out->set_name(file.name);
    out->set_error(BoundedText(file.error, kMaxMessageBytes));
    if (const auto backup = backups.find(file.name); backup != backups.end()) {
      out->set_backup(absl::StrCat("backups/", backup->second));
    }
  }
}

}  // namespace

v1::ServerState ServerStateOf(const ServerStateSources& from) {
  v1::ServerState out;
  *out.mutable_time() = TimestampOf(absl::Now());
  out.set_index_revision(from.live.snapshot()->revision);
  out.set_serving(from.live.agrees());
  const storage::DatabaseStatus database = from.catalogue.database_status();
  if (database.disk_bytes > 0) {
    v1::DiskSpace* disk = out.mutable_database_disk();
    disk->set_available_byte_count(static_cast<std::int64_t>(database.disk_available_bytes));
    disk->set_byte_count(static_cast<std::int64_t>(database.disk_bytes));
  }
  out.set_database_byte_count(static_cast<std::int64_t>(database.table_bytes + database.blob_bytes +
                                                        database.memtable_bytes));
  if (!database.write_fault.error.ok()) {
    v1::WriteFault* fault = out.mutable_write_fault();
    fault->set_error(
        BoundedText(std::string(database.write_fault.error.message()), kMaxMessageBytes));
    *fault->mutable_time() = TimestampOf(database.write_fault.begin);
  }
  SetDamage(from, &out);
  SetFiles(from, &out);
  return out;
}

}  // namespace graspdb::server
