// Stored outcomes of grasps.
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "storage/catalogue/catalogue.h"
#include "storage/changes/schema.h"
#include "tests/storage/catalogue_fixture.h"
#include "tests/storage/rocksdb_access.h"

namespace graspdb::storage {
namespace {

using ::testing::HasSubstr;

constexpr char kUpright[] = "objects/mug/stablePoses/upright";

v1::GraspOutcomeCounts Counts(const std::string& grasp, int picked, int missed, int slipped) {
  v1::GraspOutcomeCounts out;
  out.set_grasp_id(grasp);
  out.set_picked_count(picked);
  out.set_missed_count(missed);
  out.set_slipped_count(slipped);
  return out;
}

class GraspOutcomesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug")).ok());
    v1::StablePose pose = MakeStablePose("mug", "upright");  // with the grasp "top"
    pose.add_grasps()->set_grasp_id("side");
    ASSERT_TRUE(catalogue_->CreateStablePose(pose).ok());
  }

  void Reopen() {
    catalogue_.reset();
    catalogue_ = OpenOrDie(directory_ / "db");
  }

  GraspOutcomesRecord Outcomes() {
    const auto record = catalogue_->GetGraspOutcomes(kUpright);
    EXPECT_TRUE(record.ok()) << record.status();
    return *record;
  }

  absl::Status Change(const std::function<void(v1::StablePose&)>& change) {
    const auto edit = [&](v1::StablePose& pose) {
      change(pose);
      return absl::OkStatus();
    };
    return catalogue_->UpdateStablePose(kUpright, "", edit).status();
  }

  TemporaryDirectory directory_;
  std::unique_ptr<Catalogue> catalogue_ = OpenOrDie(directory_ / "db");
};

TEST_F(GraspOutcomesTest, AreSummedAndStored) {
  EXPECT_EQ(Outcomes().counts_size(), 0);
  ASSERT_TRUE(catalogue_->AddGraspOutcomes(kUpright, Counts("top", 3, 0, 0)).ok());
  ASSERT_TRUE(catalogue_->AddGraspOutcomes(kUpright, Counts("side", 0, 1, 0)).ok());
  const auto sum = catalogue_->AddGraspOutcomes(kUpright, Counts("top", 1, 0, 2));
  ASSERT_TRUE(sum.ok());
  EXPECT_EQ(sum->revision, catalogue_->revision());
  EXPECT_EQ(sum->counts.SerializeAsString(), Counts("top", 4, 0, 2).SerializeAsString());
  Reopen();
  ASSERT_EQ(Outcomes().counts_size(), 2);
  EXPECT_EQ(Outcomes().counts(0).SerializeAsString(), Counts("top", 4, 0, 2).SerializeAsString());
  EXPECT_EQ(Outcomes().counts(1).SerializeAsString(), Counts("side", 0, 1, 0).SerializeAsString());
}

TEST_F(GraspOutcomesTest, EachReportIsAChangeThatKeepsTheStablePose) {
  const std::string before = catalogue_->GetStablePose(kUpright)->SerializeAsString();
  const std::int64_t revision = catalogue_->revision();
  ASSERT_TRUE(catalogue_->AddGraspOutcomes(kUpright, Counts("top", 1, 0, 0)).ok());
  EXPECT_EQ(catalogue_->revision(), revision + 1);
  EXPECT_EQ(catalogue_->GetStablePose(kUpright)->SerializeAsString(), before);
  const auto changes = catalogue_->ReadChanges(revision, 10);
  ASSERT_TRUE(changes.ok());
  ASSERT_EQ(changes->front().mutations_size(), 1);
  EXPECT_EQ(changes->front().mutations(0).column_family(), "grasp_outcomes");
  EXPECT_EQ(changes->front().mutations(0).key(), kUpright);
  EXPECT_TRUE(TakePicture(*catalogue_).ok()) << "changes and counts agree";
}

TEST_F(GraspOutcomesTest, OfMissingGraspsAreRejected) {
  const std::int64_t revision = catalogue_->revision();
  const auto add = [this](const char* pose, const v1::GraspOutcomeCounts& counts) {
    return catalogue_->AddGraspOutcomes(pose, counts).status();
  };
  EXPECT_TRUE(absl::IsNotFound(add("objects/mug/stablePoses/none", Counts("top", 1, 0, 0))));
  const absl::Status no_grasp = add(kUpright, Counts("bottom", 1, 0, 0));
  EXPECT_TRUE(absl::IsNotFound(no_grasp));
  EXPECT_THAT(std::string(no_grasp.message()), HasSubstr("bottom"));
  EXPECT_TRUE(absl::IsInvalidArgument(add("objects/mug", Counts("top", 1, 0, 0))));
  EXPECT_TRUE(absl::IsInvalidArgument(add(kUpright, Counts("top", 0, 0, 0))));
  EXPECT_TRUE(absl::IsInvalidArgument(add(kUpright, Counts("top", 2, -1, 0))));
  EXPECT_TRUE(
      absl::IsNotFound(catalogue_->GetGraspOutcomes("objects/mug/stablePoses/none").status()));
  EXPECT_EQ(catalogue_->revision(), revision);
}

TEST_F(GraspOutcomesTest, AreDeletedWithTheirStablePose) {
  ASSERT_TRUE(catalogue_->AddGraspOutcomes(kUpright, Counts("top", 1, 0, 0)).ok());
  ASSERT_TRUE(catalogue_->DeleteStablePose(kUpright, false, "").ok());
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
  ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug", "upright")).ok());
  EXPECT_EQ(Outcomes().counts_size(), 0) << "another one of the same name starts at zero";
}

TEST_F(GraspOutcomesTest, AreDeletedWithTheirObjectOnly) {
  ASSERT_TRUE(catalogue_->CreateObject(MakeObject("mug2")).ok());
  ASSERT_TRUE(catalogue_->CreateStablePose(MakeStablePose("mug2", "upright")).ok());
  const char other[] = "objects/mug2/stablePoses/upright";
  ASSERT_TRUE(catalogue_->AddGraspOutcomes(kUpright, Counts("top", 1, 0, 0)).ok());
  ASSERT_TRUE(catalogue_->AddGraspOutcomes(other, Counts("top", 2, 0, 0)).ok());
  ASSERT_TRUE(catalogue_->DeleteObject("objects/mug", true, "").ok());
  const auto picture = TakePicture(*catalogue_);
  ASSERT_TRUE(picture.ok());
  EXPECT_EQ(picture->records.count("outcomes of " + std::string(kUpright)), 0U);
  EXPECT_EQ(catalogue_->GetGraspOutcomes(other)->counts(0).picked_count(), 2);
}

TEST_F(GraspOutcomesTest, AreKeptForUnchangedGeometry) {
  ASSERT_TRUE(catalogue_->AddGraspOutcomes(kUpright, Counts("top", 1, 0, 0)).ok());
  ASSERT_TRUE(Change([](v1::StablePose& pose) {
                pose.set_symmetry_order(4);
                pose.mutable_grasps(0)->set_priority(3);
                pose.mutable_grasps(0)->set_approach_distance_m(0.2);
                pose.mutable_grasps(0)->set_retreat_distance_m(0.3);
                pose.mutable_grasps()->SwapElements(0, 1);
              }).ok());
  ASSERT_EQ(Outcomes().counts_size(), 1);
  EXPECT_EQ(Outcomes().counts(0).picked_count(), 1);
}

TEST_F(GraspOutcomesTest, OfAChangedGraspAreRemoved) {
  ASSERT_TRUE(catalogue_->AddGraspOutcomes(kUpright, Counts("top", 1, 0, 0)).ok());
  ASSERT_TRUE(catalogue_->AddGraspOutcomes(kUpright, Counts("side", 0, 5, 0)).ok());
  ASSERT_TRUE(Change([](v1::StablePose& pose) {
                pose.mutable_grasps(1)->mutable_tcp_pose()->mutable_position()->set_z(0.1);
              }).ok());
  ASSERT_EQ(Outcomes().counts_size(), 1);
  EXPECT_EQ(Outcomes().counts(0).grasp_id(), "top");
  ASSERT_TRUE(Change([](v1::StablePose& pose) { pose.clear_grasps(); }).ok());
  EXPECT_EQ(Outcomes().counts_size(), 0);
  EXPECT_TRUE(TakePicture(*catalogue_).ok());
}

TEST_F(GraspOutcomesTest, OfAnotherOpeningOrFreeTurnAreRemoved) {
  const std::vector<std::function<void(v1::Grasp*)>> changes = {
      [](v1::Grasp* top) { top->set_gripper_opening_m(0.077); },
      [](v1::Grasp* top) { top->mutable_free_turn()->set_max_deg(60); },
      [](v1::Grasp* top) { top->mutable_free_turn()->set_max_deg(30); },
  };
  for (const auto& change : changes) {
    ASSERT_TRUE(catalogue_->AddGraspOutcomes(kUpright, Counts("top", 1, 0, 0)).ok());
    ASSERT_TRUE(Change([&](v1::StablePose& pose) { change(pose.mutable_grasps(0)); }).ok());
    EXPECT_EQ(Outcomes().counts_size(), 0);
  }
}

TEST_F(GraspOutcomesTest, AreNotStoredInTheStablePose) {
  ASSERT_TRUE(Change([](v1::StablePose& pose) {
                *pose.add_grasp_outcomes() = Counts("top", 9, 9, 9);
              }).ok());
  EXPECT_EQ(catalogue_->GetStablePose(kUpright)->grasp_outcomes_size(), 0);
  EXPECT_EQ(Outcomes().counts_size(), 0);
}

TEST_F(GraspOutcomesTest, ADatabaseOfVersion1IsMigrated) {
  catalogue_.reset();
  DropFamily(directory_ / "db", "grasp_outcomes");
  SetSchemaVersion(directory_ / "db", 1);
  Reopen();
  EXPECT_EQ(catalogue_->schema_version(), kSchemaVersion);
  EXPECT_TRUE(catalogue_->GetStablePose(kUpright).ok());
  EXPECT_TRUE(catalogue_->AddGraspOutcomes(kUpright, Counts("top", 1, 0, 0)).ok());
  Reopen();
  EXPECT_EQ(Outcomes().counts_size(), 1);
}

TEST_F(GraspOutcomesTest, InterruptedMigrationContinues) {
  catalogue_.reset();
  SetSchemaVersion(directory_ / "db", 1);  // the family exists already
  Reopen();
  EXPECT_EQ(catalogue_->schema_version(), kSchemaVersion);
  EXPECT_TRUE(catalogue_->AddGraspOutcomes(kUpright, Counts("top", 1, 0, 0)).ok());
}

TEST_F(GraspOutcomesTest, MigrationDoesNotRecreateLostFamilies) {
  catalogue_.reset();
  DropFamily(directory_ / "db", "grasp_outcomes");
  DropFamily(directory_ / "db", "cells");
  SetSchemaVersion(directory_ / "db", 1);
  EXPECT_TRUE(absl::IsDataLoss(Catalogue::Open(directory_ / "db").status()));
}

}  // namespace
}  // namespace graspdb::storage
