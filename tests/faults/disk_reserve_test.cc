// A server on a disk without a free byte: what frees space still succeeds.
#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "tests/faults/fault_fixture.h"
#include "tests/faults/small_disk.h"

namespace graspdb::faults {
namespace {

using ::testing::HasSubstr;

constexpr int kLargeMegabytes = 256;

class DiskReserveTest : public FaultTest {
 protected:
  void SetUp() override {
    if (!disk_.usable()) GTEST_SKIP() << "mounting a small file system needs root";
    std::filesystem::create_directory(Path("backups"));
    Prepare();
    Start();
    client::Client client = Connect();
    ASSERT_EQ(samples_.Prepare(client), absl::OkStatus());
    for (; taught_ < 10; ++taught_) ASSERT_EQ(Teach(client, taught_), absl::OkStatus());
  }
  void Start() { StartServer("disk/db", {"--backup-dir", Path("backups")}); }
  bool IsHeld() const { return std::filesystem::exists(Path("disk/db/RESERVE")); }
  // Fills the disk until nothing frees a byte any more, for longer than the server's watch waits.
  void Fill() const {
    using Clock = std::chrono::steady_clock;
    Clock::time_point full_since = Clock::now();
    while (Clock::now() - full_since < std::chrono::seconds(2)) {
      if (disk_.HasRoom()) {
        disk_.Fill();
        full_since = Clock::now();
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  void ExpectNoAddition(client::Client& client) const {
    const absl::Status refused = Teach(client, taught_);
    EXPECT_TRUE(absl::IsResourceExhausted(refused)) << refused;
    EXPECT_THAT(std::string(refused.message()), HasSubstr("graspdb uploads delete"));
    EXPECT_TRUE(absl::IsNotFound(client.GetView(NameOf(taught_)).status()));
  }
  // Of all but the first one.
  void PurgeOtherObjects(client::Client& client) const {
    const auto objects = client.ListObjects();
    ASSERT_TRUE(objects.ok()) << objects.status();
    for (const v1::Object& object : *objects) {
      if (NameOf(0).starts_with(object.name() + "/")) continue;
      ASSERT_EQ(client.DeleteObject(object.name(), true), absl::OkStatus());
      ASSERT_EQ(client.PurgeObject(object.name()), absl::OkStatus());
    }
  }
  void AwaitAddition(client::Client& client, int number) const {
    absl::Status again = Teach(client, number);
    while (absl::IsResourceExhausted(again)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      again = Teach(client, number);
    }
    ASSERT_TRUE(again.ok()) << again;
  }
  void ExpectViews(client::Client& client, int first) const {
    for (int i = first; i < taught_; ++i) ExpectView(client, i);
    EXPECT_EQ(client.GetCatalogStatus()->view_count(), taught_ - first);
  }

  const SmallDisk disk_{Path("disk"), kLargeMegabytes};
  int taught_ = 0;
};

TEST_F(DiskReserveTest, DeletionsAndAStartAfterAKillSucceedOnAFullDisk) {
  client::Client client = Connect();
  EXPECT_TRUE(IsHeld());
  Fill();
  ExpectNoAddition(client);
  const end_to_end::Finished doctor = Graspdb({"doctor"});
  EXPECT_EQ(doctor.exit_status, 1);
  EXPECT_THAT(doctor.out, HasSubstr("but for a reserve"));
  EXPECT_TRUE(IsHeld()) << "refusing an addition needs no space";

  EXPECT_EQ(client.DeleteView(NameOf(0)), absl::OkStatus());
  ExpectViews(client, 1);
  server_->Signal(SIGKILL);
  server_->Wait();
  Start();
  client::Client restarted = Connect();
  ExpectViews(restarted, 1);
  Fill();  // what the start has freed
  ExpectNoAddition(restarted);
  EXPECT_EQ(restarted.DeleteView(NameOf(1)), absl::OkStatus());
  Succeed({"backup", "create"});

  disk_.MakeRoom();
  AwaitAddition(restarted, taught_);
  ++taught_;
  ExpectViews(restarted, 2);
  EXPECT_TRUE(IsHeld());
  server_->Signal(SIGTERM);
  EXPECT_EQ(server_->Wait().exit_status, 0);
  Succeed({"backup", "restore", "--from", Path("backups"), "--to", Path("elsewhere")});
  StartServer("elsewhere");
  client::Client elsewhere = Connect();
  --taught_;  // after the backup
  ExpectViews(elsewhere, 2);
}

TEST_F(DiskReserveTest, WhatIsDeletedGivesRoomForAdditions) {
  client::Client client = Connect();
  constexpr int kViews = 1000;  // some 15 MB
  for (; taught_ < kViews; ++taught_) ASSERT_EQ(Teach(client, taught_), absl::OkStatus());
  Fill();
  ExpectNoAddition(client);
  PurgeOtherObjects(client);
  const int added = samples_.count() * kViews;  // of the object that is left
  AwaitAddition(client, added);
  EXPECT_TRUE(IsHeld());
  for (int i = 0; i < taught_; i += samples_.count()) ExpectView(client, i);
  ExpectView(client, added);
}

TEST_F(DiskReserveTest, WhatWasDeletedBeforeAKillGivesRoomForAdditions) {
  client::Client client = Connect();
  constexpr int kViews = 1000;  // some 15 MB
  for (; taught_ < kViews; ++taught_) ASSERT_EQ(Teach(client, taught_), absl::OkStatus());
  Fill();
  PurgeOtherObjects(client);
  server_->Signal(SIGKILL);  // likely before a compaction
  server_->Wait();
  Start();
  client::Client restarted = Connect();
  const int added = samples_.count() * kViews;  // of the object that is left
  AwaitAddition(restarted, added);
  EXPECT_TRUE(IsHeld());
  ExpectView(restarted, 0);
  ExpectView(restarted, added);
}

}  // namespace
}  // namespace graspdb::faults
