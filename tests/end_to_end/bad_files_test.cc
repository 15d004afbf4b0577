// Invalid input of the command line: one sentence, the right exit status, and a server that still
// answers.
#include <gmock/gmock.h>

#include "tests/end_to_end/fixtures/programs_fixture.h"

namespace graspdb::end_to_end {
namespace {

using ::testing::HasSubstr;

constexpr char kHeader[] =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";

// An ASCII cloud of `rows` equal rows.
std::string Cloud(int rows, const std::string& row) {
  std::string text = kHeader;
  text += "WIDTH " + std::to_string(rows) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
          std::to_string(rows) + "\nDATA ascii\n";
  for (int i = 0; i < rows; ++i) text += row + "\n";
  return text;
}

struct BadFile {
  std::string name;     // of the case
  std::string file;     // name of the file
  std::string bytes;    // content
  std::string message;  // part of the message
};

std::vector<BadFile> BadFiles() {
  const std::string huge = std::string(kHeader) +
                           "WIDTH 20000000\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
                           "POINTS 20000000\nDATA binary\n";
  const std::string truncated = std::string(kHeader) +
                                "WIDTH 100\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 100\n"
                                "DATA binary\nabc";
  return {
      {"Empty", "a.pcd", "", "a.pcd"},
      {"Text", "a.pcd", "dear colleague, the cloud is attached\n", "a.pcd"},
      {"Truncated", "a.pcd", truncated, "a.pcd"},
      {"TwentyMillionPoints", "a.pcd", huge, "20000000"},
      {"TooFewRows", "a.pcd", Cloud(20, "0 0 1").substr(0, 200), "a.pcd"},
      {"Words", "a.pcd", Cloud(20, "zero zero one"), "a.pcd"},
      {"NothingMeasured", "a.pcd", Cloud(20, "nan nan nan"), "no measurement"},
      {"OnlyZeros", "a.pcd", Cloud(20, "0 0 0"), "no measurement"},
      {"Millimetres", "a.pcd", Cloud(20, "10 20 812"), "millimetres"},
      {"UnknownEnding", "a.xyz", "0 0 1\n", "a.xyz"},
      {"ZeroViewpoint", "a.pcd",
       std::string(kHeader) +
           "WIDTH 1\nHEIGHT 1\nVIEWPOINT 0 0 1 0 0 0 0\nPOINTS 1\nDATA ascii\n0 0 1\n",
       "VIEWPOINT"},
      {"PlyWithoutBody", "a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", "a.ply"},
  };
}

class BadFileTest : public ProgramsTest {};

TEST_F(BadFileTest, RejectsEachInOneSentenceWithoutEffects) {
  StartServer();
  for (const BadFile& bad : BadFiles()) {
    SCOPED_TRACE(bad.name);
    const std::string path = folder_.Write(bad.file, bad.bytes).string();
    const Finished done = Graspdb({"recognize", path});
    EXPECT_EQ(done.exit_status, 1);
    EXPECT_THAT(done.err, HasSubstr(bad.message));
    EXPECT_EQ(CountLines(done.err), 1) << done.err;
    EXPECT_EQ(Status().catalog_revision(), 0);
  }
}

TEST_F(BadFileTest, NamesMissingFilesAndObjects) {
  StartServer();
  for (const auto& command : std::vector<std::vector<std::string>>{{"recognize", Path("no.pcd")},
                                                                   {"import", Path("no-set")},
                                                                   {"recognize", Path("")},
                                                                   {"objects", "show", "missing"},
                                                                   {"cells", "show", "nowhere"},
                                                                   {"objects", "show", "../etc"},
                                                                   {"describe", Path("no.ply")}}) {
    const Finished done = Graspdb(command);
    EXPECT_EQ(done.exit_status, 1) << command.back();
    EXPECT_EQ(CountLines(done.err), 1) << done.err;
  }
}

TEST_F(BadFileTest, RejectsADescriptorOfTooFewPoints) {
  const Finished done = Graspdb({"describe", folder_.Write("a.pcd", Cloud(9, "0 0 1")).string()});
  EXPECT_EQ(done.exit_status, 1);
  EXPECT_THAT(done.err, HasSubstr("at least 10"));
}

TEST_F(BadFileTest, ExitsWithTwoForWrongUsageAndThreeWithoutAServer) {
  for (const auto& command :
       std::vector<std::vector<std::string>>{{"fly"},
                                             {"recognize"},
                                             {"describe", "a.pcd", "--descriptor", "spin"},
                                             {"import", "set", "--split", "MAYBE"},
                                             {"describe", "a.pcd", "--viewpoint", "1,2"}}) {
    EXPECT_EQ(Graspdb(command).exit_status, 2) << command.front();
  }
  address_ = "127.0.0.1:1";
  const Finished lost = Graspdb({"status"});
  EXPECT_EQ(lost.exit_status, 3);
  EXPECT_THAT(lost.err, HasSubstr("start graspdb-server"));
}

}  // namespace
}  // namespace graspdb::end_to_end
