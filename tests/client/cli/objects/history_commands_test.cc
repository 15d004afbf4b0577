#include <gmock/gmock.h>

#include "client/cli/objects/commands.h"
#include "tests/client/catalogue_server.h"

namespace graspdb::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(RevisionText, PrintsWhatChangedAndByWhom) {
  v1::ObjectRevision revision;
  revision.set_revision(17);
  revision.set_method("UpdateObject");
  revision.set_identity("anna");
  revision.set_edit_count(3);
  v1::ResourceEdit& updated = *revision.add_edits();
  updated.set_name("objects/mug");
  updated.set_kind(v1::EDIT_KIND_UPDATED);
  updated.add_fields("labels");
  updated.add_fields("release");
  v1::ResourceEdit& deleted = *revision.add_edits();
  deleted.set_name("objects/mug/stablePoses/up");
  deleted.set_kind(v1::EDIT_KIND_DELETED);
  EXPECT_THAT(
      RevisionText(revision),
      AllOf(HasSubstr("revision 17  "), HasSubstr("UpdateObject by anna\n"),
            HasSubstr("  updated objects/mug: labels, release\n"),
            HasSubstr("  deleted objects/mug/stablePoses/up\n"), HasSubstr("  and 1 more\n")));
  revision.clear_identity();
  EXPECT_THAT(RevisionText(revision), Not(HasSubstr("by ")));
}

TEST(LocalTimeText, HasItsDistanceFromUtc) {
  google::protobuf::Timestamp time;
  time.set_seconds(1'800'000'000);
  EXPECT_THAT(LocalTimeText(time),
              ::testing::MatchesRegex("2027-01-1[0-9] [0-9:]+ [+-][0-9][0-9]:[0-9][0-9]"));
}

class HistoryCommandsTest : public ::testing::Test {
 protected:
  // Runs a command of `graspdb objects` and returns its status; its output is in `out_`.
  absl::Status Run(const std::vector<std::string>& words) {
    CLI::App app;
    GlobalOptions global;
    global.server = server_.address();
    Action action;
    AddObjectsCommand(app, global, &action);
    std::vector<std::string> reversed(words.rbegin(), words.rend());
    reversed.emplace_back("objects");
    app.parse(reversed);
    ::testing::internal::CaptureStdout();
    absl::Status status = action();
    out_ = ::testing::internal::GetCapturedStdout();
    return status;
  }

  graspdb::testing::CatalogueServer server_;
  std::string out_;
};

TEST_F(HistoryCommandsTest, FromADraftToADeletedObjectAndBack) {
  v1::CreateObjectRequest request;
  request.set_object_id("mug");
  ASSERT_TRUE(server_.client().CreateObject(request).ok());
  ASSERT_TRUE(Run({"draft", "mug"}).ok());
  EXPECT_EQ(server_.client().GetObject("objects/mug")->release(), v1::RELEASE_STATE_DRAFT);
  ASSERT_TRUE(Run({"list"}).ok());
  EXPECT_THAT(out_, HasSubstr("(draft)"));
  ASSERT_TRUE(Run({"release", "mug"}).ok());
  EXPECT_EQ(server_.client().GetObject("objects/mug")->release(), v1::RELEASE_STATE_RELEASED);

  ASSERT_TRUE(Run({"delete", "mug"}).ok());
  EXPECT_THAT(out_, AllOf(HasSubstr("deleted objects/mug\n"), HasSubstr("until "),
                          HasSubstr("graspdb objects undelete mug")));
  ASSERT_TRUE(Run({"list", "--deleted"}).ok());
  EXPECT_THAT(out_, HasSubstr("can be brought back until"));
  ASSERT_TRUE(Run({"undelete", "mug"}).ok());
  ASSERT_TRUE(Run({"history", "mug"}).ok());
  EXPECT_THAT(out_, AllOf(HasSubstr("UndeleteObject"), HasSubstr("updated objects/mug: release")));
  ASSERT_TRUE(Run({"restore", "mug", "--revision", "2"}).ok());
  EXPECT_EQ(server_.client().GetObject("objects/mug")->release(), v1::RELEASE_STATE_DRAFT);
  EXPECT_TRUE(absl::IsNotFound(Run({"purge", "mug"})));
  ASSERT_TRUE(Run({"delete", "mug"}).ok());
  ASSERT_TRUE(Run({"purge", "mug"}).ok());
  EXPECT_TRUE(absl::IsNotFound(Run({"undelete", "mug"})));
}

}  // namespace
}  // namespace graspdb::client
