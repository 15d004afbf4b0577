#include "tests/storage/catalogue_fixture.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <set>
#include <utility>

#include "gtest/gtest.h"
#include "storage/records/resource_name.h"

namespace graspdb::storage {
namespace {

// The record of the outcomes has the name of its stable pose.
std::string OutcomesOf(const std::string& stable_pose) { return "outcomes of " + stable_pose; }

// The records after replaying the change records.
absl::StatusOr<std::map<std::string, std::string>> Replay(const std::vector<ChangeRecord>& changes,
                                                          std::set<std::string>& clouds) {
  std::map<std::string, std::string> records;
  for (const ChangeRecord& change : changes) {
    for (const Mutation& mutation : change.mutations()) {
      const bool put = mutation.kind() == Mutation::KIND_PUT;
      const bool cloud = mutation.column_family() == "clouds";
      if (cloud && put) clouds.insert(mutation.key());
      if (cloud && !put) clouds.erase(mutation.key());
      const bool outcomes = mutation.column_family() == "grasp_outcomes";
      const std::string name = outcomes ? OutcomesOf(mutation.key()) : mutation.key();
      if (!cloud && put) records[name] = mutation.value();
      if (!cloud && !put) records.erase(name);
    }
  }
  return records;
}

absl::Status Contradiction(std::string_view what) {
  return absl::InternalError("the catalogue contradicts itself: " + std::string(what));
}

absl::Status CheckConsistent(const Catalogue& catalogue, const Picture& picture,
                             const std::vector<ChangeRecord>& changes,
                             const CatalogueCounts& seen) {
  const CatalogueCounts counts = catalogue.counts();
  if (counts.objects != seen.objects || counts.stable_poses != seen.stable_poses ||
      counts.views != seen.views || counts.cells != seen.cells) {
    return Contradiction("counts");
  }
  if (catalogue.revision() != picture.revision ||
      static_cast<std::int64_t>(changes.size()) != picture.revision) {
    return Contradiction("revision");
  }
  std::set<std::string> clouds;
  const auto replayed = Replay(changes, clouds);
  if (!replayed.ok()) return replayed.status();
  if (*replayed != picture.records) return Contradiction("change records");
  if (clouds.size() != picture.clouds.size()) return Contradiction("clouds");
  return absl::OkStatus();
}

}  // namespace

TemporaryDirectory::TemporaryDirectory() {
  std::string pattern = (std::filesystem::temp_directory_path() / "graspdb_test_XXXXXX").string();
  const char* made = mkdtemp(pattern.data());
  EXPECT_NE(made, nullptr);
  path_ = pattern;
}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
  EXPECT_FALSE(error) << error.message();
}

v1::Object MakeObject(std::string_view object_id, std::string_view display_name) {
  v1::Object object;
  object.set_name(MakeObjectName(object_id));
  object.set_display_name(std::string(display_name));
  return object;
}

v1::StablePose MakeStablePose(std::string_view object_id, std::string_view stable_pose_id) {
  v1::StablePose stable_pose;
  stable_pose.set_name(MakeStablePoseName(object_id, stable_pose_id));
  v1::Grasp& grasp = *stable_pose.add_grasps();
  grasp.set_grasp_id("top");
  grasp.set_gripper_opening_m(0.06);
  return stable_pose;
}

v1::Cell MakeCell(std::string_view cell_id) {
  v1::Cell cell;
  cell.set_name(MakeCellName(cell_id));
  cell.mutable_sensor_pose()->mutable_position()->set_z(0.8);
  return cell;
}

NewView MakeView(std::string_view name, int seed, std::size_t cloud_bytes) {
  NewView view;
  std::mt19937 random(static_cast<unsigned>(seed));
  view.record.set_name(std::string(name));
  view.record.set_content_digest("digest " + std::to_string(seed));
  view.record.set_point_count(100 + seed);
  DescriptorRecord& descriptor = *view.record.add_descriptors();
  descriptor.set_kind("mvfh300");
  descriptor.set_parameters("voxel=3mm");
  for (int i = 0; i < 20; ++i) descriptor.add_bins(static_cast<float>(random() % 1000) / 1000.0F);
  for (std::size_t i = 0; i < cloud_bytes; ++i) {
    view.packed_cloud += static_cast<char>(random() & 0xff);
  }
  return view;
}

std::unique_ptr<Catalogue> OpenOrDie(const std::string& directory, CatalogueOptions options) {
  auto catalogue = Catalogue::Open(directory, std::move(options));
  EXPECT_TRUE(catalogue.ok()) << catalogue.status();
  if (!catalogue.ok()) std::abort();
  return *std::move(catalogue);
}

absl::StatusOr<Picture> TakePicture(const Catalogue& catalogue) {
  Picture picture;
  CatalogueCounts seen;
  RecordVisitor visitor;
  const auto keep = [&picture](const auto& record, std::int64_t& count) {
    ++count;
    picture.records[record.name()] = record.SerializeAsString();
    return absl::OkStatus();
  };
  visitor.object = [&](const v1::Object& object) { return keep(object, seen.objects); };
  visitor.stable_pose = [&](const v1::StablePose& pose) { return keep(pose, seen.stable_poses); };
  visitor.cell = [&](const v1::Cell& cell) { return keep(cell, seen.cells); };
  visitor.view = [&](const ViewRecord& view) -> absl::Status {
    auto cloud = catalogue.GetPackedCloud(view.name());
    if (!cloud.ok()) return cloud.status();
    picture.clouds[view.name()] = *std::move(cloud);
    return keep(view, seen.views);
  };
  visitor.grasp_outcomes = [&](const GraspOutcomesRecord& outcomes) {
    picture.records[OutcomesOf(outcomes.name())] = outcomes.SerializeAsString();
    return absl::OkStatus();
  };
  const auto revision = catalogue.ForEach(visitor);
  if (!revision.ok()) return revision.status();
  picture.revision = *revision;
  std::vector<ChangeRecord> changes;
  for (bool more = true; more;) {
    auto some = catalogue.ReadChanges(changes.empty() ? 0 : changes.back().revision(), 1000);
    if (!some.ok()) return some.status();
    more = !some->empty();
    std::move(some->begin(), some->end(), std::back_inserter(changes));
  }
  for (const ChangeRecord& change : changes) {
    picture.changes[change.revision()] = change.SerializeAsString();
  }
  auto consistent = CheckConsistent(catalogue, picture, changes, seen);
  EXPECT_TRUE(consistent.ok()) << consistent;
  if (!consistent.ok()) return consistent;
  return picture;
}

void MakeHistory(Catalogue& catalogue, const std::function<void()>& after) {
  const auto done = [&after](const absl::Status& status) {
    ASSERT_TRUE(status.ok()) << status;
    after();
  };
  const std::string upright = MakeStablePoseName("mug", "upright");
  done(catalogue.CreateObject(MakeObject("mug", "Mug")).status());
  done(catalogue.CreateObject(MakeObject("bowl", "Bowl")).status());
  done(catalogue.CreateStablePose(MakeStablePose("mug", "upright")).status());
  done(catalogue.CreateStablePose(MakeStablePose("bowl", "flat")).status());
  done(catalogue.PutView(MakeView(upright + "/views/0", 1)).status());
  done(catalogue.PutView(MakeView(upright + "/views/1", 2, 50'000)).status());
  done(catalogue.PutView(MakeView("objects/bowl/stablePoses/flat/views/0", 3)).status());
  done(catalogue.CreateCell(MakeCell("line-1")).status());
  const auto rename = [](v1::Object& object) {
    object.set_display_name("Big mug");
    return absl::OkStatus();
  };
  done(catalogue.UpdateObject("objects/mug", "", rename).status());
  done(catalogue.DeleteView(upright + "/views/0"));
  done(catalogue.DeleteObject("objects/bowl", true, ""));
  done(catalogue.PutView(MakeView(upright + "/views/2", 4)).status());
}

std::string ReadBytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void WriteBytes(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  EXPECT_TRUE(file) << path;
}

void CopyDatabase(const std::string& from, const std::string& to) {
  std::filesystem::remove_all(to);
  std::filesystem::copy(from, to, std::filesystem::copy_options::recursive);
}

}  // namespace graspdb::storage
