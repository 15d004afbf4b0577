#include "client/cli/base/splits.h"

#include <gmock/gmock.h>

namespace graspdb::client {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> PathsOf(const std::vector<const v1::Capture*>& captures) {
  std::vector<std::string> paths;
  paths.reserve(captures.size());
  for (const v1::Capture* capture : captures) paths.push_back(capture->path());
  return paths;
}

class SplitsTest : public ::testing::Test {
 protected:
  SplitsTest() {
    Add("teach", v1::Capture::TEACH, "o", "p");
    Add("query", v1::Capture::QUERY, "o", "p");
    Add("unknown", v1::Capture::QUERY, "", "");
    Add("either", v1::Capture::SPLIT_UNSPECIFIED, "o", "p");
  }

  void Add(const std::string& path, v1::Capture::Split split, const std::string& object,
           const std::string& pose) {
    v1::Capture* capture = set_.add_captures();
    capture->set_path(path);
    capture->set_split(split);
    capture->set_object_id(object);
    capture->set_stable_pose_id(pose);
  }

  v1::CaptureSet set_;
};

TEST_F(SplitsTest, ACaptureWithoutASplitIsInBoth) {
  EXPECT_THAT(PathsOf(CapturesOfSplit(set_, "TEACH")), ElementsAre("teach", "either"));
  EXPECT_THAT(PathsOf(CapturesOfSplit(set_, "QUERY")), ElementsAre("query", "unknown", "either"));
  EXPECT_THAT(PathsOf(CapturesOfSplit(set_, "ALL")),
              ElementsAre("teach", "query", "unknown", "either"));
}

TEST_F(SplitsTest, OnlyLabelledCapturesCanBeTaught) {
  EXPECT_THAT(PathsOf(TeachableCaptures(set_, "ALL")), ElementsAre("teach", "query", "either"));
}

TEST_F(SplitsTest, TheFlagRejectsOtherValues) {
  std::string split = "TEACH";
  CLI::App app;
  AddSplitFlag(app, &split);
  app.parse("--split QUERY");
  EXPECT_EQ(split, "QUERY");
  EXPECT_THROW(app.parse("--split BOTH"), CLI::ParseError);
}

}  // namespace
}  // namespace graspdb::client
