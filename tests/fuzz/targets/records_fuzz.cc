// Databases with modified records and clouds: the server fails to start or answers.
#include <rocksdb/db.h>

#include <cstdint>
#include <memory>
#include <optional>

#include "server/live/live_catalogue.h"
#include "server/live/view_cloud_cache.h"
#include "server/recognition/frame_recognizer.h"
#include "storage/catalogue/catalogue.h"
#include "storage/database/family.h"
#include "storage/records/packed_cloud.h"
#include "tests/fuzz/fuzz_server.h"
#include "tests/fuzz/message_target.h"
#include "tests/fuzz/operations.pb.h"
#include "tests/fuzz/requirement.h"
#include "tests/fuzz/sample_frames.h"

namespace graspdb::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr char kView[] = "objects/l-bracket/stablePoses/flat/views/0";

const std::vector<std::string>& Words() {
  static const std::vector<std::string> words = {kView,
                                                 "objects/l-bracket",
                                                 "objects/l-bracket/stablePoses/flat",
                                                 "meta",
                                                 "objects/z",
                                                 "cells/z",
                                                 "gsh288",
                                                 "graspdb"};
  return words;
}

std::string CloudOf(const std::string& floats) {
  std::vector<storage::CloudPoint> points(floats.size() / sizeof(storage::CloudPoint));
  if (points.empty()) return floats;
  std::memcpy(points.data(), floats.data(), points.size() * sizeof(storage::CloudPoint));
  return storage::PackCloud(points).value_or(floats);
}

// Key and value of a record.
std::pair<std::string, std::string> Pair(const StoredRecord& record) {
  const auto named = [&](const auto& message) {
    const std::string& key = record.key().empty() ? message.name() : record.key();
    return std::pair(key, message.SerializeAsString());
  };
  switch (record.value_case()) {
    case StoredRecord::kObject:
      return named(record.object());
    case StoredRecord::kStablePose:
      return named(record.stable_pose());
    case StoredRecord::kView:
      return named(record.view());
    case StoredRecord::kCell:
      return named(record.cell());
    case StoredRecord::kOutcomes:
      return named(record.outcomes());
    case StoredRecord::kMeta:
      return {"meta", record.meta().SerializeAsString()};
    case StoredRecord::kFloats:
      return {record.key(), CloudOf(record.floats())};
    case StoredRecord::kRaw:
    case StoredRecord::VALUE_NOT_SET:
      break;
  }
  return {record.key(), record.raw()};
}

void WriteRecords(const std::string& directory, const StoredDatabase& database) {
  std::vector<rocksdb::ColumnFamilyDescriptor> families;
  for (const std::string_view name : storage::kFamilyNames) {
    families.emplace_back(std::string(name), rocksdb::ColumnFamilyOptions());
  }
  rocksdb::DB* db = nullptr;
  std::vector<rocksdb::ColumnFamilyHandle*> handles;
  Require(rocksdb::DB::Open(rocksdb::DBOptions(), directory, families, &handles, &db).ok(),
          "the database opens");
  const std::unique_ptr<rocksdb::DB> owner(db);
  for (const StoredRecord& record : database.records()) {
    const auto [key, value] = Pair(record);
    const auto family = static_cast<std::uint32_t>(record.family()) % storage::kFamilyCount;
    Require(db->Put(rocksdb::WriteOptions(), handles[family], key, value).ok(), "a put");
  }
  for (rocksdb::ColumnFamilyHandle* handle : handles) db->DestroyColumnFamilyHandle(handle);
}

// Starts a server on the records and answers a frame.
void Use(storage::Catalogue& catalogue) {
  const recognition::RecognitionParameters parameters;
  const auto live = server::LiveCatalogue::Follow(catalogue, parameters.descriptor);
  catalogue.ForEach({}).status().IgnoreError();
  catalogue.ListObjects(100, "").status().IgnoreError();
  catalogue.ListCells(100, "").status().IgnoreError();
  catalogue.GetGraspOutcomes("objects/l-bracket/stablePoses/flat").status().IgnoreError();
  catalogue.ReadChanges(0, 1000).status().IgnoreError();
  if (!live.ok()) return;
  server::ViewCloudCache clouds(catalogue, parameters.descriptor, std::size_t{16} << 20U);
  server::FrameRecognizer recognizer(catalogue, **live, clouds, parameters, kMaxPoints);
  static const v1::RecognizeRequest frame = [] {
    v1::RecognizeRequest request;
    const v1::UploadViewsRequest seen = SegmentedView(kFusedPart, 30, "seen", false);
    *request.mutable_cloud() = seen.view().cloud();
    *request.mutable_sensor_pose() = seen.view().sensor_pose();
    request.set_segmented(true);
    return request;
  }();
  recognizer.Answer(frame, [] { return false; }).status().IgnoreError();
}

void Run(const StoredDatabase& database) {
  static FuzzServer server;
  static const std::string original = [] {
    server.TeachParts();
    server.Stop();
    return server.database();
  }();
  const std::string copy = original + ".copy";
  fs::remove_all(copy);
  fs::copy(original, copy, fs::copy_options::recursive);
  WriteRecords(copy, database);
  const auto catalogue = storage::Catalogue::Open(copy);
  if (!catalogue.ok()) return;
  Use(**catalogue);
}

}  // namespace
}  // namespace graspdb::fuzz

GRASPDB_FUZZ_MESSAGES(graspdb::fuzz::StoredDatabase, graspdb::fuzz::Words(), graspdb::fuzz::Run)
