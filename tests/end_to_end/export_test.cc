// Export, import into another server, and replaced views.
#include <gmock/gmock.h>
#include <google/protobuf/util/message_differencer.h>

#include <fstream>
#include <sstream>

#include "tests/end_to_end/outcome_matchers.h"
#include "tests/end_to_end/programs_fixture.h"
#include "tests/end_to_end/view_names.h"

namespace graspdb::end_to_end {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class ExportTest : public ProgramsTest {
 protected:
  void SetUp() override {
    StartServer();
    Simulate("set", 60, 4);
    Succeed({"import", Path("set")});
  }

  std::vector<v1::RecognizeResponse> Answers() const {
    std::istringstream in(Recognize("set"));
    std::vector<v1::RecognizeResponse> out;
    for (std::string line; std::getline(in, line);) {
      out.push_back(ResponseOf(line).value_or(v1::RecognizeResponse()));
      out.back().clear_catalog_revision();
    }
    return out;
  }
};

// Poses are normalised on every upload, which may change their last bit.
TEST_F(ExportTest, AnImportedExportHasTheSameViewsAndGivesTheSameAnswers) {
  const std::set<std::string> names = ViewNames(address_);
  EXPECT_EQ(names.size(), 18U);
  const std::vector<v1::RecognizeResponse> before = Answers();
  ASSERT_EQ(before.size(), 4U);
  Succeed({"export", Path("exported")});
  StartServer("fresh");
  Succeed({"import", Path("exported")});
  EXPECT_EQ(ViewNames(address_), names);
  const std::vector<v1::RecognizeResponse> after = Answers();
  ASSERT_EQ(after.size(), before.size());
  google::protobuf::util::DefaultFieldComparator numbers;
  numbers.set_float_comparison(google::protobuf::util::DefaultFieldComparator::APPROXIMATE);
  numbers.SetDefaultFractionAndMargin(1e-6, 1e-9);
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(before[i].status(), v1::OK);
    google::protobuf::util::MessageDifferencer differencer;
    differencer.set_field_comparator(&numbers);
    std::string difference;
    differencer.ReportDifferencesToString(&difference);
    EXPECT_TRUE(differencer.Compare(before[i], after[i])) << difference;
  }
}

TEST_F(ExportTest, PrintsAndAppliesProposedThresholds) {
  EXPECT_THAT(
      Succeed({"objects", "thresholds", "flange", "--apply"}).out,
      AllOf(HasSubstr("objects/flange/stablePoses/"), HasSubstr(": as all; 6 of 6 views named"),
            Not(HasSubstr("objects/wedge/stablePoses/flat:")),
            Not(HasSubstr("nothing was changed"))));
}

TEST_F(ExportTest, ExportsAndImportsThresholds) {
  std::string json = client::BytesOf(Path("set/captures.json"));
  const std::string pose = "\"stablePoseId\":";
  json.insert(json.find(pose), "\"minScore\": 0.25, ");
  std::ofstream(Path("set/captures.json")) << json;
  StartServer("with");
  Succeed({"import", Path("set")});
  Succeed({"export", Path("exported")});
  EXPECT_THAT(client::BytesOf(Path("exported/captures.json")), HasSubstr("minScore"));
  StartServer("fresh");
  Succeed({"import", Path("exported")});
  EXPECT_THAT(Succeed({"objects", "list"}).out, HasSubstr("objects/"));
  const std::string first = json.substr(json.find("\"objectId\":"), 60);
  const std::size_t from = first.find('"', 11) + 1;
  const std::string id = first.substr(from, first.find('"', from) - from);
  EXPECT_THAT(Succeed({"objects", "show", id}).out, HasSubstr("minimum score 0.25"));
}

TEST_F(ExportTest, WritesOnlyTheNamedObject) {
  Succeed({"export", Path("exported"), "--object", "flange"});
  const std::string json = client::BytesOf(Path("exported/captures.json"));
  EXPECT_THAT(json, HasSubstr("\"flange\""));
  EXPECT_THAT(json, Not(HasSubstr("l-bracket")));
}

TEST_F(ExportTest, DoesNotOverwriteAnExistingSet) {
  const std::string before = client::BytesOf(Path("set/captures.json"));
  const Finished done = Graspdb({"export", Path("set")});
  EXPECT_THAT(done, EndsWith(1));
  EXPECT_THAT(done, SaysOnly("graspdb", "choose another folder"));
  EXPECT_EQ(client::BytesOf(Path("set/captures.json")), before);
}

TEST_F(ExportTest, ReplaceTeachesAllViewsAgainUnderTheirNames) {
  const std::set<std::string> names = ViewNames(address_);
  EXPECT_THAT(Succeed({"import", Path("set"), "--replace"}).out,
              HasSubstr("taught 18 views, 0 were there already"));
  EXPECT_EQ(ViewNames(address_), names);
}

}  // namespace
}  // namespace graspdb::end_to_end
