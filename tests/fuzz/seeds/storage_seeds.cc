#include <iterator>

#include "storage/catalogue/catalogue.h"
#include "storage/database/family.h"
#include "storage/records/packed_cloud.h"
#include "tests/fuzz/fuzz_server.h"
#include "tests/fuzz/operations.pb.h"
#include "tests/fuzz/requirement.h"
#include "tests/fuzz/seeds/seed_writer.h"

namespace graspdb::fuzz {
namespace {

storage::ViewRecord FirstView(const storage::Catalogue& catalogue) {
  storage::ViewRecord out;
  storage::RecordVisitor visitor;
  visitor.view = [&](const storage::ViewRecord& view) {
    if (out.name().empty()) out = view;
    return absl::OkStatus();
  };
  const auto read = catalogue.ForEach(visitor);
  Require(read.ok() && !out.name().empty(), "a view was taught");
  return out;
}

StoredRecord& Add(StoredDatabase& database, storage::Family family) {
  StoredRecord& record = *database.add_records();
  record.set_family(static_cast<int>(family));
  return record;
}

void WriteFiles(const SeedWriter& out, const storage::Catalogue& catalogue,
                const storage::ViewRecord& view) {
  const absl::StatusOr<std::string> cloud = catalogue.GetPackedCloud(view.name());
  Require(cloud.ok(), "a view has a cloud");
  out.Write("storage_file", "cloud", *cloud);
}

void WriteLogs(const SeedWriter& out, const std::string& directory) {
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    const bool is_log = entry.path().extension() == ".log";
    const bool is_manifest = entry.path().filename().string().starts_with("MANIFEST-");
    if (!is_log && !is_manifest) continue;
    out.Write("storage_file", is_log ? "log" : "manifest", BytesOf(entry.path()).substr(0, 4000));
  }
}

void WriteRecords(const SeedWriter& out, const storage::Catalogue& catalogue,
                  const storage::ViewRecord& view) {
  StoredDatabase records;
  *Add(records, storage::Family::kViews).mutable_view() = view;
  StoredRecord& cloud = Add(records, storage::Family::kClouds);
  cloud.set_key(view.name());
  const auto points = storage::UnpackCloud(*catalogue.GetPackedCloud(view.name()));
  for (std::size_t i = 0; i < points->size(); i += 4) {
    cloud.mutable_floats()->append(reinterpret_cast<const char*>((*points)[i].data()), 12);
  }
  out.Write("records", "view", records.SerializeAsString());
  StoredDatabase others;
  const std::string pose_name = view.name().substr(0, view.name().find("/views/"));
  *Add(others, storage::Family::kStablePoses).mutable_stable_pose() =
      catalogue.GetStablePose(pose_name).value();
  Add(others, storage::Family::kObjects).mutable_object()->set_name("objects/z");
  Add(others, storage::Family::kCells).mutable_cell()->set_name("cells/z");
  auto& outcomes = *Add(others, storage::Family::kGraspOutcomes).mutable_outcomes();
  outcomes.set_name(pose_name);
  outcomes.add_counts()->set_grasp_id("top");
  out.Write("records", "others", others.SerializeAsString());
}

}  // namespace

void WriteStorageSeeds(const SeedWriter& out) {
  FuzzServer server;
  server.TeachParts();
  server.Stop();
  const auto catalogue = storage::Catalogue::Open(server.database()).value();
  const storage::ViewRecord view = FirstView(*catalogue);
  WriteFiles(out, *catalogue, view);
  WriteLogs(out, server.database());
  WriteRecords(out, *catalogue, view);
}

}  // namespace graspdb::fuzz
