// A catalogue with an object that changes, and its history.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "storage/database/database.h"
#include "storage/history/history.h"
#include "tests/storage/catalogue_fixture.h"

namespace graspdb::storage {

inline constexpr char kMug[] = "objects/mug";
inline constexpr char kMugUpright[] = "objects/mug/stablePoses/upright";
inline constexpr absl::Time kStart = absl::FromUnixSeconds(1'800'000'000);

inline std::string MugView(int i) {
  return std::string(kMugUpright) + "/views/" + std::to_string(i);
}

// Without what a restored record has of its own.
inline std::map<std::string, std::string> ContentOf(const Picture& picture) {
  std::map<std::string, std::string> out = picture.records;
  for (auto& [name, bytes] : out) {
    if (name.find("/views/") != std::string::npos) continue;
    v1::Object object;
    v1::StablePose pose;
    if (name.find("/stablePoses/") != std::string::npos && pose.ParseFromString(bytes)) {
      pose.clear_etag();
      pose.clear_update_time();
      bytes = pose.SerializeAsString();
    } else if (object.ParseFromString(bytes)) {
      object.clear_etag();
      object.clear_update_time();
      bytes = object.SerializeAsString();
    }
  }
  return out;
}

class HistoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Open();
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug", "Mug")).ok());
    ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
    for (int i = 0; i < 3; ++i) Put(i);
    // Neighbours in the order of keys.
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug-2")).ok());
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mugs")).ok());
  }

  void Open() {
    catalogue_.reset();
    CatalogueOptions options;
    options.clock = [this] { return now_; };
    catalogue_ = OpenOrDie(directory_ / "db", options);
  }

  void Put(int i, int seed = 1) {
    ASSERT_EQ(*catalogue_->PutView(MakeView(MugView(i), seed, 6000)), PutViewOutcome::kCreated);
  }
  void Pick(int count) {
    v1::GraspOutcomeCounts counts;
    counts.set_grasp_id("top");
    counts.set_picked_count(count);
    ASSERT_TRUE(catalogue_->AddGraspOutcomes(kMugUpright, counts).ok());
  }
  void Rename(const std::string& display_name) {
    const auto renamed = catalogue_->UpdateObject(kMug, "", [&](v1::Object& object) {
      object.set_display_name(display_name);
      return absl::OkStatus();
    });
    ASSERT_TRUE(renamed.ok()) << renamed.status();
  }
  void OpenGripper(double opening_m) {
    const auto changed = catalogue_->UpdateStablePose(kMugUpright, "", [&](v1::StablePose& pose) {
      pose.mutable_grasps(0)->set_gripper_opening_m(opening_m);
      return absl::OkStatus();
    });
    ASSERT_TRUE(changed.ok()) << changed.status();
  }
  void DeleteMug() { ASSERT_TRUE(catalogue_->DeleteObject(kMug, /*force=*/true, "").ok()); }

  // Also checks that counts, clouds and change records match the records.
  Picture Take() {
    const auto picture = TakePicture(*catalogue_);
    EXPECT_TRUE(picture.ok()) << picture.status();
    return picture.ok() ? *picture : Picture();
  }
  std::vector<std::int64_t> RevisionsOf(const std::string& object) {
    std::vector<std::int64_t> out;
    const auto page = history().List(object, 1000, 0);
    EXPECT_TRUE(page.ok()) << page.status();
    for (const auto& row : page->records) out.push_back(row.revision());
    return out;
  }
  // Keys in the family `clouds`, of a closed database.
  std::vector<std::string> StoredClouds() {
    catalogue_.reset();
    std::vector<std::string> out;
    {
      const auto database = Database::Open(directory_ / "db", {});
      EXPECT_TRUE((*database)
                      ->Scan(Family::kClouds, "", "",
                             [&](std::string_view key, std::string_view) -> absl::StatusOr<bool> {
                               out.emplace_back(key);
                               return true;
                             })
                      .ok());
    }
    Open();
    return out;
  }

  History& history() { return catalogue_->history(); }

  absl::Time now_ = kStart;
  TemporaryDirectory directory_;
  std::unique_ptr<Catalogue> catalogue_;
};

}  // namespace graspdb::storage
