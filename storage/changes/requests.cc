#include "storage/changes/requests.h"

#include "base/status_macros.h"
#include "storage/database/family.h"
#include "storage/records/record_kind.h"

namespace graspdb::storage {
namespace {

using google::protobuf::Timestamp;

// A write adds one; with two their number falls again after a busy time.
constexpr int kForgottenAtOnce = 2;

std::string KeyOfRequest(std::string_view id) { return "request/" + std::string(id); }

std::string KeyOfNumber(std::uint64_t number) {
  return "request_number/" + ChangeKey(static_cast<std::int64_t>(number));
}

bool IsOldRequest(const Timestamp& time, const Timestamp& now) {
  return absl::FromUnixSeconds(now.seconds()) - absl::FromUnixSeconds(time.seconds()) >
         kKeptRequestTime;
}

// None if there is no record with this key.
absl::StatusOr<std::optional<RequestRecord>> ReadRequest(const Database& database,
                                                         std::string_view id) {
  const auto bytes = database.Get(Family::kMeta, KeyOfRequest(id));
  if (absl::IsNotFound(bytes.status())) return std::nullopt;
  if (!bytes.ok()) return bytes.status();
  RequestRecord record;
  if (!record.ParseFromString(*bytes) || record.id() != id) {
    return DamagedRecord("request " + std::string(id));
  }
  return record;
}

// Deletes the oldest record if it need not be kept; false if it must.
absl::StatusOr<bool> ForgetOldestRequest(const Database& database, const Timestamp& now,
                                         MetaRecord& meta, rocksdb::WriteBatch& batch) {
  const std::uint64_t number = meta.request_horizon() + 1;
  const auto id = database.Get(Family::kMeta, KeyOfNumber(number));
  if (!id.ok() && !absl::IsNotFound(id.status())) return id.status();
  if (id.ok()) {
    ASSIGN_OR_RETURN(const auto record, ReadRequest(database, *id));
    // Another number: the id was used again after it was forgotten.
    const bool has_record = record.has_value() && record->number() == number;
    const bool is_kept = has_record && meta.request_count() - number < kKeptRequests &&
                         !IsOldRequest(record->time(), now);
    if (is_kept) return false;
    absl::Status status = database.Delete(Family::kMeta, KeyOfNumber(number), batch);
    if (has_record) status.Update(database.Delete(Family::kMeta, KeyOfRequest(*id), batch));
    if (!status.ok()) return status;
  }
  meta.set_request_horizon(number);
  return true;
}

}  // namespace

absl::StatusOr<std::optional<RequestRecord>> FindRequest(const Database& database,
                                                         std::string_view id,
                                                         std::string_view content_digest,
                                                         const Timestamp& now) {
  auto record = ReadRequest(database, id);
  if (!record.ok() || !record->has_value()) return record;
  if (IsOldRequest((*record)->time(), now)) return std::nullopt;
  if ((*record)->content_digest() == content_digest) return record;
  return absl::AlreadyExistsError("the request id " + std::string(id) +
                                  " was used for another request; take a new one for each request, "
                                  "and the same only to repeat it");
}

absl::Status KeepRequest(const Database& database, RequestRecord record, const Timestamp& now,
                         MetaRecord& meta, rocksdb::WriteBatch& batch) {
  meta.set_request_count(meta.request_count() + 1);
  for (int i = 0; i < kForgottenAtOnce && meta.request_horizon() + 1 < meta.request_count(); ++i) {
    ASSIGN_OR_RETURN(const auto forgotten, ForgetOldestRequest(database, now, meta, batch));
    if (!forgotten) break;
  }
  record.set_number(meta.request_count());
  *record.mutable_time() = now;
  absl::Status status =
      database.Put(Family::kMeta, KeyOfRequest(record.id()), record.SerializeAsString(), batch);
  status.Update(database.Put(Family::kMeta, KeyOfNumber(record.number()), record.id(), batch));
  return status;
}

}  // namespace graspdb::storage
