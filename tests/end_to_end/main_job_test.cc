// The main job with real processes: teach views, recognize scenes, get object and pose.
#include <gmock/gmock.h>

#include <csignal>

#include "tests/end_to_end/fixtures/programs_fixture.h"

namespace graspdb::end_to_end {
namespace {

using ::testing::HasSubstr;

using MainJobTest = ProgramsTest;

TEST_F(MainJobTest, RecognizesTaughtPartsInNewScenes) {
  StartServer();
  Simulate("set", 15, 12);
  const Finished taught = Graspdb({"import", Path("set"), "--json"});
  ASSERT_EQ(taught.exit_status, 0) << taught.err;
  EXPECT_THAT(taught.out, HasSubstr("\"createdCount\":72"));
  const std::string answers = Recognize("set");
  EXPECT_EQ(CountLines(answers), 12);
  EXPECT_GE(CountRight(answers), 11) << answers;
}

TEST_F(MainJobTest, ImportingTwiceTeachesNothingTwice) {
  StartServer();
  Simulate("set", 60, 1);
  ASSERT_EQ(Graspdb({"import", Path("set")}).exit_status, 0);
  const auto before = Status();
  const Finished again = Graspdb({"import", Path("set")});
  EXPECT_EQ(again.exit_status, 0);
  EXPECT_THAT(again.out, HasSubstr("taught 0 views, 18 were there already"));
  EXPECT_EQ(Status().catalog_revision(), before.catalog_revision());
}

TEST_F(MainJobTest, ExportedCatalogueGivesTheSameAnswersElsewhere) {
  StartServer("first");
  Simulate("set", 30, 6);
  ASSERT_EQ(Graspdb({"import", Path("set")}).exit_status, 0);
  const std::string listed = Graspdb({"objects", "list"}).out;
  const Finished exported = Graspdb({"export", Path("exported")});
  ASSERT_EQ(exported.exit_status, 0) << exported.err;
  StartServer("second");
  const Finished imported = Graspdb({"import", Path("exported")});
  ASSERT_EQ(imported.exit_status, 0) << imported.err;
  EXPECT_EQ(Graspdb({"objects", "list"}).out, listed);
  EXPECT_EQ(Status().view_count(), 36);
  EXPECT_EQ(CountRight(Recognize("set")), 6);
}

TEST_F(MainJobTest, SameSceneGivesTheSameBytesOnOneAndTwoThreadsAndAfterARestart) {
  StartServer("db", {"--workers", "2"});
  Simulate("set", 30, 3);
  ASSERT_EQ(Graspdb({"import", Path("set")}).exit_status, 0);
  // Twice at once, so that both threads have work.
  const auto other = StartGraspdb(RecognizeWords("set"));
  const std::string before = Recognize("set");
  EXPECT_EQ(other->Wait().out, before);
  server_->Signal(SIGTERM);
  EXPECT_EQ(server_->Wait().exit_status, 0);
  StartServer("db", {"--workers", "1"});
  EXPECT_EQ(Recognize("set"), before);
}

}  // namespace
}  // namespace graspdb::end_to_end
