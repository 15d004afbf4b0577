// A server whose disk is full, or read-only, at the start or while it runs.
#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/faults/ext4_disk.h"
#include "tests/faults/fault_fixture.h"
#include "tests/faults/small_disk.h"

namespace graspdb::faults {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

// Less than RocksDB reserves for a log (1.1 write buffers): writes would go on within that.
constexpr int kMegabytes = 14;

class DiskTest : public FaultTest {
 protected:
  const SmallDisk disk_{Path("disk"), kMegabytes};
};

#define SKIP_WITHOUT_DISK() \
  if (!disk_.usable()) GTEST_SKIP() << "mounting a small file system needs root"

TEST_F(DiskTest, AFullDiskRejectsWritesUntilThereIsRoomWithoutARestart) {
  SKIP_WITHOUT_DISK();
  Prepare();
  StartServer("disk/db", {"--disk-reserve-mib", "0"});
  client::Client client = Connect();
  ASSERT_EQ(samples_.Prepare(client), absl::OkStatus());
  int taught = 0;
  for (int round = 0; round < 3; ++round) {
    for (const int more = taught + 5; taught < more; ++taught) {
      ASSERT_EQ(Teach(client, taught), absl::OkStatus());
    }
    disk_.Fill();
    absl::Status full = Teach(client, taught);
    for (; full.ok(); full = Teach(client, taught)) ++taught;  // the last block has room
    EXPECT_TRUE(absl::IsResourceExhausted(full)) << full;
    EXPECT_THAT(std::string(full.message()), HasSubstr("free space on the disk"));
    for (int i = 0; i < taught; ++i) ExpectView(client, i);
    EXPECT_TRUE(absl::IsNotFound(client.GetView(NameOf(taught)).status()));
    const auto answer = client.Recognize(samples_.Scan(0));
    ASSERT_TRUE(answer.ok()) << answer.status();
    EXPECT_EQ(answer->detections(0).candidates(0).view(), NameOf(0));

    disk_.MakeRoom();
    absl::Status again = Teach(client, taught);
    while (absl::IsResourceExhausted(again)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      again = Teach(client, taught);
    }
    ASSERT_TRUE(again.ok()) << again;
    ExpectView(client, taught++);
  }
  server_->Signal(SIGKILL);
  server_->Wait();
  StartServer("disk/db");
  client::Client restarted = Connect();
  for (int i = 0; i < taught; ++i) ExpectView(restarted, i);
  EXPECT_EQ(restarted.GetCatalogStatus()->view_count(), taught);
}

TEST_F(DiskTest, AFullOrReadOnlyDiskEndsTheStartWithASentence) {
  SKIP_WITHOUT_DISK();
  const std::vector<std::string> no_reserve = {"--disk-reserve-mib", "0"};
  StartServer("disk/db", no_reserve);
  ASSERT_EQ(samples_.Prepare(*std::make_unique<client::Client>(Connect())), absl::OkStatus());
  server_->Signal(SIGTERM);
  server_->Wait();
  std::vector<std::string> start = ServerCommand(Path("disk/db"), "127.0.0.1:0");
  start.insert(start.end(), no_reserve.begin(), no_reserve.end());
  disk_.Fill();
  const end_to_end::Finished full = end_to_end::RunProgram(folder_.path(), start);
  EXPECT_EQ(full.exit_status, 1);
  EXPECT_THAT(full.err, HasSubstr("No space left on device"));
  EXPECT_THAT(full.err, HasSubstr(Path("disk/db")));
  disk_.MakeRoom();

  ASSERT_TRUE(disk_.SetReadOnly(true));
  const end_to_end::Finished read_only = end_to_end::RunProgram(folder_.path(), start);
  EXPECT_EQ(read_only.exit_status, 1);
  EXPECT_THAT(read_only.err, HasSubstr("Read-only file system"));
  EXPECT_THAT(read_only.err, HasSubstr("check the disk"));
  ASSERT_TRUE(disk_.SetReadOnly(false));
  StartServer("disk/db");
  EXPECT_EQ(Status().object_count(), samples_.count());
}

class ReadOnlyDiskTest : public FaultTest {
 protected:
  Ext4Disk disk_{folder_.path(), "disk"};
};

TEST_F(ReadOnlyDiskTest, AFileSystemThatTurnsReadOnlyRejectsWritesAndReadsGoOn) {
  if (!disk_.usable()) {
    GTEST_SKIP() << "an ext4 that can turn read-only needs root, mkfs.ext4, a free loop device and "
                    "a writable /sys";
  }
  constexpr int kTaught = 10;
  Prepare();
  StartServer("disk/db");
  {
    client::Client client = Connect();
    ASSERT_EQ(samples_.Prepare(client), absl::OkStatus());
    for (int i = 0; i < kTaught / 2; ++i) ASSERT_EQ(Teach(client, i), absl::OkStatus());
  }
  server_->Signal(SIGTERM);
  server_->Wait();
  StartServer("disk/db");  // these views are in files now, and the following ones in the log
  client::Client client = Connect();
  for (int i = kTaught / 2; i < kTaught; ++i) ASSERT_EQ(Teach(client, i), absl::OkStatus());

  ASSERT_TRUE(disk_.Fail());
  for (int attempt = 0; attempt < 2; ++attempt) {
    const absl::Status refused = Teach(client, kTaught);
    EXPECT_TRUE(absl::IsUnavailable(refused)) << refused;
    // The kernel's answer to a sync depends on whether ext4 was committing when it failed.
    EXPECT_THAT(std::string(refused.message()),
                AnyOf(HasSubstr("Read-only file system"), HasSubstr("Input/output error")));
    EXPECT_THAT(std::string(refused.message()), HasSubstr("check the disk"));
  }
  EXPECT_TRUE(absl::IsUnavailable(client.DeleteView(NameOf(0))));
  for (int i = 0; i < kTaught; ++i) {
    ExpectView(client, i);
    const auto answer = client.Recognize(samples_.Scan(i));
    ASSERT_TRUE(answer.ok()) << answer.status();
    EXPECT_EQ(answer->detections(0).candidates(0).view(), NameOf(i));
  }
  EXPECT_TRUE(absl::IsNotFound(client.GetView(NameOf(kTaught)).status()));
  server_->Signal(SIGTERM);
  EXPECT_EQ(server_->Wait().exit_status, 0);

  ASSERT_TRUE(disk_.MountAgain());
  StartServer("disk/db");
  client::Client restarted = Connect();
  for (int i = 0; i < kTaught; ++i) ExpectView(restarted, i);
  EXPECT_EQ(restarted.GetCatalogStatus()->view_count(), kTaught);
  EXPECT_TRUE(Teach(restarted, kTaught).ok());
  ExpectView(restarted, kTaught);
}

}  // namespace
}  // namespace graspdb::faults
