// Export, import into another server, and replaced views.
#include <gmock/gmock.h>
#include <google/protobuf/util/message_differencer.h>

#include <csignal>
#include <fstream>
#include <sstream>

#include "client/sdk/client.h"
#include "tests/end_to_end/fixtures/outcome_matchers.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"
#include "tests/end_to_end/fixtures/view_names.h"

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

TEST_F(ExportTest, AnArchiveGivesAnotherServerTheSameViewsAndTheSameAnswers) {
  const std::set<std::string> names = ViewNames(address_);
  const std::vector<v1::RecognizeResponse> before = Answers();
  EXPECT_THAT(Succeed({"export", Path("all.graspdb")}).out,
              HasSubstr("wrote 18 views of 3 objects"));
  StartServer("fresh");
  EXPECT_THAT(Succeed({"import", Path("all.graspdb"), "--dry-run"}).out,
              HasSubstr("views                0        18"));
  EXPECT_EQ(Status().view_count(), 0);
  EXPECT_THAT(Succeed({"import", Path("all.graspdb")}).out,
              HasSubstr("created 3 objects, 3 stable poses and 18 views, replaced 0 records"));
  EXPECT_EQ(ViewNames(address_), names);
  const std::vector<v1::RecognizeResponse> after = Answers();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i].SerializeAsString(), before[i].SerializeAsString()) << i;
  }
  const std::int64_t revision = Status().catalog_revision();
  EXPECT_THAT(Succeed({"import", Path("all.graspdb"), "--json"}).out,
              AllOf(HasSubstr("\"createdViews\":0"), HasSubstr("\"same\":18")));
  EXPECT_EQ(Status().catalog_revision(), revision);
}

TEST_F(ExportTest, ADamagedArchiveIsRejectedBeforeAnythingIsWritten) {
  Succeed({"export", Path("all.graspdb")});
  std::string bytes = files::BytesOf(Path("all.graspdb"));
  bytes[bytes.size() - 100] = static_cast<char>(bytes[bytes.size() - 100] ^ 1);
  folder_.Write("damaged.graspdb", bytes);
  StartServer("fresh");
  const Finished done = Graspdb({"import", Path("damaged.graspdb")});
  EXPECT_THAT(done, EndsWith(1));
  EXPECT_THAT(done, PrintsOnly("graspdb", "copy the file again, or export it again"));
  EXPECT_EQ(Status().catalog_revision(), 0);
}

TEST_F(ExportTest, AConflictIsRejectedBeforeAnythingIsWritten) {
  Succeed({"export", Path("all.graspdb")});
  StartServer("fresh");
  Succeed({"import", Path("all.graspdb"), "--object", "flange"});
  client::Client client({address_, absl::Minutes(2)});
  v1::UpdateObjectRequest renamed;
  renamed.mutable_object()->set_name("objects/flange");
  renamed.mutable_object()->set_display_name("Another flange");
  ASSERT_TRUE(client.UpdateObject(renamed).ok());
  const std::int64_t revision = Status().catalog_revision();
  for (const bool json : {false, true}) {
    std::vector<std::string> words = {"import", Path("all.graspdb"), "--dry-run"};
    if (json) words.emplace_back("--json");
    const Finished dry = Graspdb(words);
    EXPECT_THAT(dry, EndsWith(1)) << "as the import itself";
    EXPECT_THAT(dry.out, HasSubstr("undecided"));
    EXPECT_THAT(dry.err, HasSubstr("an import would write nothing; choose --on-conflict"));
  }
  Succeed({"import", Path("all.graspdb"), "--dry-run", "--on-conflict", "keep"});
  const Finished failed = Graspdb({"import", Path("all.graspdb")});
  EXPECT_THAT(failed, EndsWith(1));
  EXPECT_THAT(failed.err,
              AllOf(HasSubstr("conflict undecided objects/flange, changed later on the server"),
                    HasSubstr("choose --on-conflict keep, replace or later")));
  EXPECT_EQ(Status().catalog_revision(), revision);
  Succeed({"import", Path("all.graspdb"), "--on-conflict", "keep"});
  EXPECT_EQ(Status().view_count(), 18);
}

TEST_F(ExportTest, AKilledImportIsContinued) {
  Succeed({"export", Path("all.graspdb")});
  StartServer("fresh");
  const Finished early = Graspdb({"import", Path("all.graspdb"), "--resume"});
  EXPECT_THAT(early, EndsWith(1));
  EXPECT_THAT(early.err, HasSubstr("leave out --resume"));
  const std::unique_ptr<Process> import = StartGraspdb({"import", Path("all.graspdb")});
  // Killed at any moment of its work; all of them have to end with the same catalogue.
  for (int i = 0; i < 500 && Status().stable_pose_count() == 0; ++i) {
  }
  import->Signal(SIGKILL);
  import->Wait();
  Succeed({"import", Path("all.graspdb")});
  EXPECT_EQ(Status().view_count(), 18);
}

TEST_F(ExportTest, FlagsOfTheOtherFormatAreErrors) {
  Succeed({"export", Path("all.graspdb")});
  EXPECT_THAT(Graspdb({"import", Path("all.graspdb"), "--replace"}),
              PrintsOnly("graspdb", "--replace is for capture sets"));
  EXPECT_THAT(Graspdb({"import", Path("set"), "--on-conflict", "keep"}),
              PrintsOnly("graspdb", "--on-conflict is for archives"));
  const Finished again = Graspdb({"export", Path("all.graspdb")});
  EXPECT_THAT(again, EndsWith(1));
  EXPECT_THAT(again, PrintsOnly("graspdb", "choose another file"));
}

TEST_F(ExportTest, PrintsAndAppliesProposedThresholds) {
  EXPECT_THAT(
      Succeed({"objects", "thresholds", "flange", "--apply"}).out,
      AllOf(HasSubstr("objects/flange/stablePoses/"), HasSubstr(": as all; 6 of 6 views named"),
            Not(HasSubstr("objects/wedge/stablePoses/flat:")),
            Not(HasSubstr("nothing was changed"))));
}

TEST_F(ExportTest, ExportsAndImportsThresholds) {
  std::string json = files::BytesOf(Path("set/captures.json"));
  const std::string pose = "\"stablePoseId\":";
  json.insert(json.find(pose), "\"minScore\": 0.25, ");
  std::ofstream(Path("set/captures.json")) << json;
  StartServer("with");
  Succeed({"import", Path("set")});
  Succeed({"export", Path("exported")});
  EXPECT_THAT(files::BytesOf(Path("exported/captures.json")), HasSubstr("minScore"));
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
  const std::string json = files::BytesOf(Path("exported/captures.json"));
  EXPECT_THAT(json, HasSubstr("\"flange\""));
  EXPECT_THAT(json, Not(HasSubstr("l-bracket")));
}

TEST_F(ExportTest, DoesNotOverwriteAnExistingSet) {
  const std::string before = files::BytesOf(Path("set/captures.json"));
  const Finished done = Graspdb({"export", Path("set")});
  EXPECT_THAT(done, EndsWith(1));
  EXPECT_THAT(done, PrintsOnly("graspdb", "choose another folder"));
  EXPECT_EQ(files::BytesOf(Path("set/captures.json")), before);
}

TEST_F(ExportTest, AFolderThatCannotBeMadeIsNamed) {
  const std::string before = files::BytesOf(Path("set/captures.json"));
  const Finished done = Graspdb({"export", Path("set/captures.json/below")});
  EXPECT_THAT(done, EndsWith(1));
  EXPECT_THAT(done,
              PrintsOnly("graspdb", "cannot make the folder " + Path("set/captures.json/below")));
  EXPECT_EQ(files::BytesOf(Path("set/captures.json")), before);
}

TEST_F(ExportTest, ReplaceKeepsIdenticalViews) {
  const std::set<std::string> names = ViewNames(address_);
  EXPECT_THAT(Succeed({"import", Path("set"), "--replace"}).out,
              HasSubstr("taught 0 views, 18 were there already"));
  EXPECT_EQ(ViewNames(address_), names);
}

}  // namespace
}  // namespace graspdb::end_to_end
