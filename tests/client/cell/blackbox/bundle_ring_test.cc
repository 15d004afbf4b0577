#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <vector>

#include "client/cell/blackbox/bundle_files.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

absl::Time Noon() { return absl::FromUnixSeconds(1'783'080'000); }

class BundleRingTest : public ::testing::Test {
 protected:
  BundleRing Open(std::uint64_t limit = 1000) const {
    auto ring = BundleRing::Open({.folder = Folder(), .byte_limit = limit, .min_free_bytes = 0});
    EXPECT_THAT(ring, IsOk());
    return *std::move(ring);
  }

  std::filesystem::path Folder() const { return folder_.path() / "bundles"; }

  std::vector<std::string> Names() const {
    std::vector<std::string> out;
    for (const auto& entry : std::filesystem::directory_iterator(Folder())) {
      out.push_back(entry.path().filename().string());
    }
    std::sort(out.begin(), out.end());
    return out;
  }

  files::TemporaryFolder folder_;
};

TEST_F(BundleRingTest, FilesAreNumberedAndNamedByTheirTime) {
  BundleRing ring = Open();
  ASSERT_THAT(ring.Add("one", Noon()), IsOk());
  ASSERT_THAT(ring.Add("two", Noon() - absl::Hours(1)), IsOk());
  EXPECT_THAT(Names(), ElementsAre("0000000001-20260703T120000Z.bundle",
                                   "0000000002-20260703T110000Z.bundle"));
}

TEST_F(BundleRingTest, RemovesTheOldestAtTheLimit) {
  BundleRing ring = Open(1000);
  for (int i = 0; i < 25; ++i) {
    ASSERT_THAT(ring.Add(std::string(100, 'x'), Noon()), IsOk());
    EXPECT_LE(Names().size(), 10U);
  }
  EXPECT_THAT(Names(), SizeIs(10));
  EXPECT_EQ(Names().front().substr(0, 10), "0000000016");
  ASSERT_THAT(ring.Add(std::string(950, 'y'), Noon()), IsOk());
  EXPECT_THAT(Names(), SizeIs(1));
}

TEST_F(BundleRingTest, ABundleLargerThanTheLimitIsRejectedAndNothingIsRemoved) {
  BundleRing ring = Open(1000);
  ASSERT_THAT(ring.Add(std::string(100, 'x'), Noon()), IsOk());
  EXPECT_THAT(ring.Add(std::string(1001, 'x'), Noon()),
              StatusIs(absl::StatusCode::kResourceExhausted));
  EXPECT_THAT(Names(), SizeIs(1));
}

TEST_F(BundleRingTest, TakesOverExistingBundles) {
  {
    BundleRing ring = Open();
    for (int i = 0; i < 5; ++i) ASSERT_THAT(ring.Add(std::string(100, 'x'), Noon()), IsOk());
  }
  BundleRing ring = Open(350);
  EXPECT_THAT(Names(), SizeIs(3)) << "the limit is smaller now";
  ASSERT_THAT(ring.Add("x", Noon()), IsOk());
  EXPECT_EQ(Names().back().substr(0, 10), "0000000006");
  EXPECT_EQ(Names().front().substr(0, 10), "0000000003");
}

TEST_F(BundleRingTest, RemovesTemporaryFilesOfACrashAndKeepsOtherFiles) {
  Open();
  for (const char* name : {"0000000007-20260703T120000Z.bundle.4711.tmp", "notes.txt",
                           "mine.bundle", "0000000003-x.txt"}) {
    std::ofstream(Folder() / name) << std::string(5000, 'x');
  }
  Open();
  EXPECT_THAT(Names(), ElementsAre("0000000003-x.txt", "mine.bundle", "notes.txt"));
}

TEST_F(BundleRingTest, ABundleRemovedByAnotherProcessIsNoError) {
  BundleRing ring = Open(200);
  ASSERT_THAT(ring.Add(std::string(100, 'x'), Noon()), IsOk());
  std::filesystem::remove_all(Folder());
  EXPECT_THAT(ring.Add(std::string(150, 'x'), Noon()), IsOk());
  EXPECT_THAT(Names(), SizeIs(1));
}

TEST_F(BundleRingTest, KeepsTheMinimumFreeSpace) {
  {
    BundleRing ring = Open();
    ASSERT_THAT(ring.Add("x", Noon()), IsOk());
  }
  auto ring = BundleRing::Open({.folder = Folder(),
                                .byte_limit = 1000,
                                .min_free_bytes = std::numeric_limits<std::uint64_t>::max() / 2});
  ASSERT_THAT(ring, IsOk());
  EXPECT_THAT(Names(), IsEmpty());
  EXPECT_THAT(ring->Add("y", Noon()), StatusIs(absl::StatusCode::kResourceExhausted));
}

TEST_F(BundleRingTest, AFolderInUseIsAnErrorUntilItsRingIsGone) {
  {
    const BundleRing ring = Open();
    EXPECT_THAT(BundleRing::Open({.folder = Folder(), .byte_limit = 1000, .min_free_bytes = 0}),
                StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("in use")));
  }
  Open();
}

TEST_F(BundleRingTest, AnUnusableFolderIsAnError) {
  std::ofstream(folder_.path() / "file") << "x";
  EXPECT_FALSE(BundleRing::Open({.folder = folder_.path() / "file" / "inside"}).ok());
}

}  // namespace
}  // namespace graspdb::client
