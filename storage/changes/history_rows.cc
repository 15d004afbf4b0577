#include "storage/changes/history_rows.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/util/message_differencer.h>

#include "storage/database/family.h"
#include "storage/records/record_kind.h"

namespace graspdb::storage {
namespace {

// Bytes of values after which a row ends. Lists read the first row of each change.
constexpr std::size_t kMaxRowBytes = 64U << 10;

constexpr std::size_t kPartBytes = sizeof(std::uint32_t);

std::string BigEndian(std::uint32_t number) {
  std::string out(kPartBytes, '\0');
  for (std::size_t i = out.size(); i-- > 0; number >>= 8) out[i] = static_cast<char>(number & 0xff);
  return out;
}

bool IsKept(Family family, const PreviousRecord& previous) {
  return family == Family::kObjects || family == Family::kStablePoses || family == Family::kViews ||
         (family == Family::kGraspOutcomes && previous.removed());
}

}  // namespace

std::string HistoryPrefix(std::string_view object_name) { return std::string(object_name) + "/"; }

std::string HistoryKey(std::string_view object_name, std::int64_t revision, std::uint32_t part) {
  return HistoryPrefix(object_name) + ChangeKey(~revision) + BigEndian(part);
}

std::string_view ObjectOf(std::string_view key) {
  return key.substr(0, key.find('/', key.find('/') + 1));
}

absl::StatusOr<HistoryRecord> ParseRow(std::string_view key, std::string_view bytes) {
  const std::string_view object = ObjectOf(key);
  HistoryRecord row;
  // The whole key must fit, so that readers that seek from row to row get on.
  if (row.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())) && key.size() > kPartBytes &&
      key.substr(0, key.size() - kPartBytes) ==
          HistoryPrefix(object) + ChangeKey(~row.revision())) {
    return row;
  }
  return DamagedRecord("the history of " + std::string(object));
}

std::vector<std::string> ChangedFields(const google::protobuf::Message& before,
                                       const google::protobuf::Message& after) {
  using google::protobuf::util::MessageDifferencer;
  std::vector<std::string> out;
  const auto* type = before.GetDescriptor();
  for (int i = 0; i < type->field_count(); ++i) {
    const auto* field = type->field(i);
    if (field->name() == "etag" || field->name() == "update_time") continue;
    if (!MessageDifferencer().CompareWithFields(before, after, {field}, {field})) {
      out.push_back(field->name());
    }
  }
  return out;
}

void HistoryRows::Add(const ChangeRecord& change, Family family, std::string_view key,
                      PreviousRecord previous) {
  if (!IsKept(family, previous)) return;
  const std::string object(ObjectOf(key));
  Rows& rows = rows_[{change.revision(), object}];
  if (rows.first.revision() == 0) {
    rows.first.set_revision(change.revision());
    *rows.first.mutable_time() = change.time();
    rows.first.set_identity(author_.identity);
    rows.first.set_method(author_.method);
    rows.open = rows.first;
  }
  if (rows.bytes > kMaxRowBytes) {
    if (rows.parts > 1) {
      status_.Update(database_.Put(Family::kHistory,
                                   HistoryKey(object, change.revision(), rows.parts - 1),
                                   rows.open.SerializeAsString(), rocks_));
      rows.open.clear_previous();
    }
    ++rows.parts;
    rows.bytes = 0;
  }
  if (family != Family::kGraspOutcomes) rows.first.set_edit_count(rows.first.edit_count() + 1);
  previous.set_column_family(std::string(FamilyName(family)));
  previous.set_key(std::string(key));
  rows.bytes += previous.ByteSizeLong();
  *(rows.parts > 1 ? rows.open : rows.first).add_previous() = std::move(previous);
}

absl::Status HistoryRows::Finish() {
  const auto put = [&](const std::string& object, const HistoryRecord& row, std::uint32_t part) {
    status_.Update(database_.Put(Family::kHistory, HistoryKey(object, row.revision(), part),
                                 row.SerializeAsString(), rocks_));
  };
  for (const auto& [place, rows] : rows_) {
    put(place.second, rows.first, 0);
    if (rows.parts > 1) put(place.second, rows.open, rows.parts - 1);
  }
  return status_;
}

}  // namespace graspdb::storage
