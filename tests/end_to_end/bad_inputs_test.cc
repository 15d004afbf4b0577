// Invalid files and command lines: each has its exit status and one sentence on stderr, nothing on
// stdout, and changes nothing.
#include <gmock/gmock.h>

#include <functional>
#include <ostream>

#include "tests/end_to_end/fixtures/outcome_matchers.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"
#include "tests/end_to_end/fixtures/written_clouds.h"

namespace graspdb::end_to_end {
namespace {

using Words = std::vector<std::string>;

struct BadInput {
  std::string name;
  // Writes the files and returns the arguments.
  std::function<Words(const files::TemporaryFolder&)> make;
  std::string words;
};

void PrintTo(const BadInput& bad, std::ostream* out) { *out << bad.name; }
std::string NameOf(const ::testing::TestParamInfo<BadInput>& info) { return info.param.name; }

class BadInputTest : public ProgramsTest, public ::testing::WithParamInterface<BadInput> {};

TEST_P(BadInputTest, FailsWithOneSentenceAndChangesNothing) {
  StartServer("db", {"--max-points", "1000"});
  const Finished outcome = Graspdb(GetParam().make(folder_));
  EXPECT_THAT(outcome, EndsWith(1));
  EXPECT_THAT(outcome, PrintsOnly("graspdb", GetParam().words));
  EXPECT_EQ(outcome.out.find("OK"), std::string::npos) << outcome.out;
  EXPECT_EQ(Status().catalog_revision(), 0);
}

// `recognize` of a file with these bytes.
BadInput File(const std::string& name, const std::string& file, const std::string& bytes,
              const std::string& words) {
  return {name,
          [=](const files::TemporaryFolder& folder) -> Words {
            return {"recognize", folder.Write(file, bytes).string()};
          },
          words};
}

// A command on a capture set whose captures.json is `json`, beside a good cloud.
BadInput Set(const std::string& name, const std::string& command, const std::string& json,
             const std::string& words) {
  return {name,
          [=](const files::TemporaryFolder& folder) -> Words {
            folder.Write("captures.json", json);
            folder.Write("cloud.pcd", AsciiPcd(CurvedPatch(400)));
            return {command, folder.path().string()};
          },
          words};
}

BadInput Arguments(const std::string& name, const Words& arguments, const std::string& words) {
  return {name, [=](const files::TemporaryFolder&) { return arguments; }, words};
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

std::vector<BadInput> Files() {
  const std::string good = AsciiPcd(CurvedPatch(400));
  const std::string nan_rows = "nan nan nan\nnan nan nan\nnan nan nan\n";
  const std::string empty = AsciiPcd({});
  return {
      File("TextNamedPcd", "a.pcd", "Dear diary,\ntoday I found a cloud.\n", "not a PCD file"),
      File("EmptyFile", "a.pcd", "", "a.pcd"),
      File("TruncatedRows", "a.pcd", good.substr(0, good.rfind('\n', good.size() / 2) + 1),
           "its header promises"),
      File("TruncatedBinary", "a.pcd",
           Replaced(good, "DATA ascii\n", "DATA binary\n").substr(0, 900), "its header promises"),
      File("TwentyMillionPointsInTheHeader", "a.pcd",
           Replaced(Replaced(empty, "WIDTH 0", "WIDTH 20000000"), "POINTS 0", "POINTS 20000000"),
           "20000000 points"),
      File("NoPoints", "a.pcd", empty, "promises no points"),
      File("NoX", "a.pcd", Replaced(good, "FIELDS x y z", "FIELDS u y z"), "named x"),
      File("WrongStride", "a.pcd", Replaced(good, "SIZE 4 4 4", "SIZE 4 4"), "SIZE line"),
      File("NotAWord", "a.pcd", Replaced(good, "DATA ascii\n", "DATA ascii\nzero 0 0\n"),
           "\"zero\""),
      File("OnlyNan", "a.pcd",
           Replaced(Replaced(empty, "WIDTH 0", "WIDTH 3"), "POINTS 0", "POINTS 3") + nan_rows,
           "no measurement"),
      File("Millimetres", "a.pcd",
           AsciiPcd({{100, 0, 650}, {0, 100, 650}, {0, 0, 660}, {5, 5, 640}}), "millimetres"),
      File("MoreThanTheServerTakes", "a.pcd", AsciiPcd(CurvedPatch(1001)), "--max-points"),
      File("PlyThatIsNone", "a.ply", "ply\nformat paper 1.0\n", "a.ply"),
      File("AnotherKindOfFile", "a.docx", "PK", "a.docx"),
  };
}

std::vector<BadInput> Sets() {
  const std::string query = "\"split\": \"QUERY\"";
  const std::string taught = "\"split\": \"TEACH\", \"objectId\": \"o\", \"stablePoseId\": \"p\"";
  const auto pose = [](const std::string& x, const std::string& w) {
    return ", \"sensorPose\": {\"position\": {\"x\": " + x + "}, \"orientation\": {\"w\": " + w +
           "}}";
  };
  return {
      Arguments("MissingFile", {"recognize", "/nonexistent/a.pcd"}, "/nonexistent/a.pcd"),
      Arguments("MissingSet", {"import", "/nonexistent/set"}, "captures.json"),
      {"FolderWithoutSet",
       [](const files::TemporaryFolder& folder) -> Words {
         return {"recognize", folder.path().string()};
       },
       "captures.json"},
      Set("SetThatIsNoJson", "recognize", "{\"captures\": [", "captures.json"),
      Set("SetWithZeroQuaternion", "recognize", CaptureSetJson(query + pose("0", "0")),
          "captures[0].sensorPose"),
      Set("SetWithInfinitePosition", "recognize", CaptureSetJson(query + pose("\"Infinity\"", "1")),
          "captures[0].sensorPose"),
      Set("SetThatLeadsOut", "recognize",
          Replaced(CaptureSetJson(query), "cloud.pcd", "../../etc/passwd"), "leads out"),
      Set("SetOfAnUndeclaredObject", "import",
          Replaced(CaptureSetJson(taught), "\"objectId\": \"o\"", "\"objectId\": \"q\""),
          "\"o\" is not in objects"),
      Set("SetWithoutTeachCaptures", "import", CaptureSetJson(query), "--split"),
      Set("SetWithoutQueryCaptures", "recognize", "{}", "no captures"),
      Set("SetWithMissingCloud", "recognize",
          Replaced(CaptureSetJson(query), "cloud.pcd", "lost.pcd"), "lost.pcd"),
      Set("SetWithRegionUpsideDown", "recognize",
          R"({"regionOfInterest": {"min": {"z": 1}, "max": {"z": 0}}})", "min above max"),
  };
}

std::vector<BadInput> Names() {
  const auto recognize_with_cell = [](const std::string& cell) {
    return [=](const files::TemporaryFolder& folder) -> Words {
      return {"recognize", folder.Write("a.pcd", AsciiPcd(CurvedPatch(400))).string(), "--cell",
              cell};
    };
  };
  return {
      {"UnknownCell", recognize_with_cell("nowhere"), "cells/nowhere"},
      {"MalformedCell", recognize_with_cell("not a name"), "not a name"},
      Arguments("UnknownObject", {"objects", "show", "nothing"}, "objects/nothing"),
      Arguments("MalformedObject", {"objects", "show", "a b"}, "a b"),
      Arguments("DeleteOfAnUnknownObject", {"objects", "delete", "nothing"}, "objects/nothing"),
      Arguments("ExportOfAnUnknownObject", {"export", "/nonexistent/set", "--object", "nothing"},
                "objects/nothing"),
      Arguments("CellWithRegionUpsideDown", {"cells", "set", "c", "--region", "0,0,1,1,1,0"},
                "region_of_interest"),
      Arguments("CellWithZeroQuaternion", {"cells", "set", "c", "--sensor-pose", "0,0,1,0,0,0,0"},
                "unit quaternion"),
      Arguments("CellFromAMissingFile", {"cells", "set", "c", "--from", "/nonexistent/cell.json"},
                "/nonexistent/cell.json"),
      {"CellFromNoJson",
       [](const files::TemporaryFolder& folder) -> Words {
         return {"cells", "set", "c", "--from", folder.Write("c.json", "{]").string()};
       },
       "c.json"},
      {"DescribeFromAViewpointThatIsNone",
       [](const files::TemporaryFolder& folder) -> Words {
         return {"describe", folder.Write("a.pcd", AsciiPcd(CurvedPatch(100))).string(),
                 "--viewpoint", "inf,0,0"};
       },
       "viewpoint must be finite"},
      {"DescribeOfPointsInOnePlace",
       [](const files::TemporaryFolder& folder) -> Words {
         const recognition::Points points(50, Eigen::Vector3f(0.1F, 0.2F, 0.6F));
         return {"describe", folder.Write("a.pcd", AsciiPcd(points)).string()};
       },
       "a.pcd"},
  };
}

INSTANTIATE_TEST_SUITE_P(Files, BadInputTest, ::testing::ValuesIn(Files()), NameOf);
INSTANTIATE_TEST_SUITE_P(Sets, BadInputTest, ::testing::ValuesIn(Sets()), NameOf);
INSTANTIATE_TEST_SUITE_P(Names, BadInputTest, ::testing::ValuesIn(Names()), NameOf);

}  // namespace
}  // namespace graspdb::end_to_end
