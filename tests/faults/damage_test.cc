// Flipped bytes in the files of a database.
#include <gmock/gmock.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <vector>

#include "tests/faults/fault_fixture.h"

namespace graspdb::faults {
namespace {

using ::testing::HasSubstr;

class DamageTest : public FaultTest {
 protected:
  void Stop() {
    server_->Signal(SIGTERM);
    server_->Wait();
  }
  // A database with one view of each content, all of them in sorted files and blob files.
  void MakeDatabase() {
    Prepare();
    StartServer();
    client::Client client = Connect();
    ASSERT_EQ(samples_.Prepare(client), absl::OkStatus());
    for (int i = 0; i < samples_.count(); ++i) ASSERT_EQ(Teach(client, i), absl::OkStatus());
    Stop();
    StartServer();  // moves the log into files
    Stop();
  }
  std::vector<std::filesystem::path> Files(const char* extension) const {
    std::vector<std::filesystem::path> out;
    for (const auto& entry : std::filesystem::directory_iterator(Path("db"))) {
      if (entry.path().extension() == extension) out.push_back(entry.path());
    }
    return out;
  }
  static void Flip(const std::filesystem::path& path, std::uintmax_t offset) {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekg(static_cast<std::streamoff>(offset));
    const int byte = file.get();
    file.seekp(static_cast<std::streamoff>(offset));
    file.put(static_cast<char>(byte ^ 0x41));
  }
};

TEST_F(DamageTest, ADamagedCloudIsNamedAndAllOthersAreServed) {
  MakeDatabase();
  const std::vector<std::filesystem::path> blobs = Files(".blob");
  ASSERT_EQ(blobs.size(), 1U);
  Flip(blobs[0], std::filesystem::file_size(blobs[0]) / 2);
  StartServer();
  client::Client client = Connect();
  int damaged = -1;
  for (int i = 0; i < samples_.count(); ++i) {
    const auto view = client.GetView(NameOf(i));
    if (!view.ok()) {
      EXPECT_EQ(damaged, -1) << "one byte is in one cloud";
      damaged = i;
      EXPECT_TRUE(absl::IsDataLoss(view.status())) << view.status();
      EXPECT_THAT(std::string(view.status().message()), HasSubstr(NameOf(i)));
      EXPECT_THAT(std::string(view.status().message()), HasSubstr("restore a backup"));
    } else {
      EXPECT_TRUE(samples_.IsStored(*view, i)) << i;
    }
  }
  ASSERT_NE(damaged, -1);
  for (int i = 0; i < samples_.count(); ++i) {
    const auto answer = client.Recognize(samples_.Scan(i));
    if (!answer.ok()) {
      EXPECT_TRUE(absl::IsDataLoss(answer.status())) << answer.status();
      continue;
    }
    const v1::Detection& found = answer->detections(0);
    if (found.object().empty()) continue;
    EXPECT_EQ(found.stable_pose(), samples_.StablePoseOf(i)) << "never a wrong answer";
    EXPECT_NE(i, damaged);
  }
}

TEST_F(DamageTest, ADeletedFileOfCloudsIsNamedAndAllOtherViewsAreServed) {
  MakeDatabase();
  const std::filesystem::path first = Files(".blob").front();
  std::filesystem::create_directory(Path("backups"));
  StartServer("db", {"--backup-dir", Path("backups")});
  constexpr int kMore = 5;  // views of another file, of some of the stable poses
  {
    client::Client client = Connect();
    for (int i = 0; i < kMore; ++i) {
      ASSERT_EQ(Teach(client, samples_.count() + i), absl::OkStatus());
    }
    Succeed({"backup", "create"});
  }
  Stop();
  StartServer();
  Stop();
  ASSERT_EQ(Files(".blob").size(), 2U);
  std::filesystem::remove(first);
  StartServer("db", {"--backup-dir", Path("backups")});
  client::Client client = Connect();
  for (int i = 0; i < samples_.count(); ++i) {
    const auto view = client.GetView(NameOf(i));
    EXPECT_TRUE(absl::IsDataLoss(view.status())) << view.status();
    EXPECT_THAT(std::string(view.status().message()), HasSubstr(first.filename().string()));
  }
  for (int i = 0; i < kMore; ++i) {
    ExpectView(client, samples_.count() + i);
    const auto answer = client.Recognize(samples_.Scan(i));
    ASSERT_TRUE(answer.ok()) << answer.status();
    EXPECT_EQ(answer->detections(0).candidates(0).view(), NameOf(samples_.count() + i));
  }
  const end_to_end::Finished doctor = Graspdb({"doctor"});
  EXPECT_EQ(doctor.exit_status, 1);
  EXPECT_THAT(doctor.out, HasSubstr("file " + first.filename().string() + " is damaged"));
  EXPECT_THAT(doctor.out, HasSubstr("backups/1 has it"));
  EXPECT_THAT(Succeed({"status"}).out, HasSubstr("damaged     " + first.filename().string()));
  EXPECT_TRUE(server_->WaitForError("event=record_left_out"));
  ASSERT_EQ(Teach(client, 2 * samples_.count()), absl::OkStatus());
  Stop();
  Succeed({"backup", "restore", "--from", Path("backups"), "--to", Path("restored")});
  StartServer("restored");
  client::Client restored = Connect();
  for (int i = 0; i < samples_.count() + kMore; ++i) ExpectView(restored, i);
}

TEST_F(DamageTest, DamagedSortedFilesAreNamedOrReadAsTheyWere) {
  MakeDatabase();
  int named = 0;
  for (const std::filesystem::path& file : Files(".sst")) {
    const std::uintmax_t size = std::filesystem::file_size(file);
    for (const std::uintmax_t offset : {size / 50, size / 3}) {
      std::filesystem::remove_all(Path("copy"));
      std::filesystem::copy(Path("db"), Path("copy"));
      Flip(std::filesystem::path(Path("copy")) / file.filename(), offset);
      server_ = std::make_unique<end_to_end::Process>(folder_.path(),
                                                      ServerCommand(Path("copy"), "127.0.0.1:0"));
      address_ = server_->WaitForLine("listening on ");
      if (address_.empty()) {
        const end_to_end::Finished refused = server_->Wait();
        EXPECT_EQ(refused.exit_status, 1);
        EXPECT_THAT(refused.err, HasSubstr(file.filename().string()));
        EXPECT_THAT(refused.err, HasSubstr("restore a backup"));
        ++named;
        continue;
      }
      client::Client client = Connect();
      for (int i = 0; i < samples_.count(); ++i) {
        const auto view = client.GetView(NameOf(i));
        if (view.ok()) {
          EXPECT_TRUE(samples_.IsStored(*view, i)) << i;
        } else {
          EXPECT_TRUE(absl::IsDataLoss(view.status())) << view.status();
          EXPECT_THAT(std::string(view.status().message()), HasSubstr(file.filename().string()));
        }
      }
    }
  }
  EXPECT_GT(named, 2);
}

}  // namespace
}  // namespace graspdb::faults
