#include <gmock/gmock.h>

#include <cstdint>
#include <filesystem>

#include "client/cell/blackbox/bundle_files.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

v1::Bundle Sample() {
  v1::Bundle out;
  out.set_robot("10.0.0.7");
  out.set_job(7);
  out.mutable_request()->set_cell("cells/press-3");
  out.mutable_request()->mutable_cloud()->set_data(std::string(1000, '\x7f'));
  out.mutable_response()->set_status(v1::NO_CLUSTER);
  return out;
}

class BundleFileTest : public ::testing::Test {
 protected:
  files::TemporaryFolder folder_;
};

TEST_F(BundleFileTest, SurvivesARoundTrip) {
  const std::string path = folder_.Write("a.bundle", *BundleBytes(Sample()));
  const auto read = ReadBundle(path);
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(read->SerializeAsString(), Sample().SerializeAsString());
}

TEST_F(BundleFileTest, InvalidFilesAreReported) {
  const std::string bytes = *BundleBytes(Sample());
  for (const std::string& wrong :
       {std::string(), std::string("GB"), std::string("PLY\x01 something"), bytes.substr(0, 4),
        bytes.substr(0, bytes.size() - 3), "GBB\x01" + std::string(50, '\xff')}) {
    EXPECT_THAT(ReadBundle(folder_.Write("wrong.bundle", wrong)),
                StatusIs(absl::StatusCode::kDataLoss, HasSubstr("wrong.bundle")));
  }
  std::string newer = bytes;
  newer[3] = 2;
  EXPECT_THAT(ReadBundle(folder_.Write("newer.bundle", newer)),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("newer")));
  EXPECT_THAT(ReadBundle(folder_.path() / "none"), StatusIs(absl::StatusCode::kNotFound));
}

TEST_F(BundleFileTest, AFileThatIsLargerThanAnyBundleIsNotRead) {
  const std::filesystem::path path = folder_.Write("large.bundle", *BundleBytes(Sample()));
  std::filesystem::resize_file(path, std::uintmax_t{3} << 30U);  // a hole: takes no space
  EXPECT_THAT(ReadBundle(path), StatusIs(absl::StatusCode::kDataLoss, HasSubstr("large.bundle")));
}

TEST_F(BundleFileTest, ListsTheBundlesOfFoldersTheOldestFirst) {
  const std::string second = folder_.Write("0000000010-x.bundle", "");
  const std::string first = folder_.Write("0000000009-y.bundle", "");
  folder_.Write("notes.txt", "");
  const auto listed = ListBundles({folder_.path().string(), first});
  ASSERT_THAT(listed, IsOk());
  EXPECT_THAT(*listed, ElementsAre(first, second, first));
  EXPECT_THAT(ListBundles({"/nowhere/at/all"}), StatusIs(absl::StatusCode::kNotFound));
  const std::filesystem::path empty = folder_.path() / "empty";
  std::filesystem::create_directory(empty);
  EXPECT_THAT(ListBundles({empty.string()}),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("no bundles")));
}

}  // namespace
}  // namespace graspdb::client
