// The index beside the database: used if valid, rejected if not; responses are the same.
#include "server/index_snapshot.h"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <set>

#include "tests/server/server_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

using ::testing::HasSubstr;

constexpr auto kRefused = absl::StatusCode::kFailedPrecondition;

std::string ReadBytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void WriteBytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

class IndexSnapshotTest : public ServerTest {
 protected:
  void SetUp() override {
    ServerTest::SetUp();
    Teach("wedge", 3);
    server_.reset();
  }

  std::filesystem::path Index() const { return IndexOf(options_.database); }
  static std::filesystem::path IndexOf(const std::filesystem::path& database) {
    return database / "INDEX";
  }

  // The views that a server would load, while it is down.
  absl::StatusOr<server::LoadedViews> Load(const std::filesystem::path& database,
                                           double voxel_size_m = 0.003) const {
    const auto catalogue = storage::Catalogue::Open(database);
    if (!catalogue.ok()) return catalogue.status();
    recognition::DescriptorParameters parameters;
    parameters.voxel_size_m = voxel_size_m;
    return server::ReadIndexSnapshot(**catalogue, parameters);
  }
  absl::StatusOr<server::LoadedViews> Load() const { return Load(options_.database); }

  // The response of a server that starts on the existing files, and stops.
  std::string AnswerOfARun() {
    Start();
    std::string answer = Answer(request_).SerializeAsString();
    server_.reset();
    return answer;
  }

  // From the records only.
  std::string RightAnswer() {
    std::filesystem::remove(Index());
    return AnswerOfARun();
  }

  std::filesystem::path CopyOfTheDatabase() const {
    std::filesystem::path copy = folder_.path() / "copy";
    std::filesystem::copy(options_.database, copy, std::filesystem::copy_options::recursive);
    return copy;
  }

  const v1::RecognizeRequest request_ = RequestOf(Photograph("wedge", {.turn_deg = 8}, 3));
};

TEST_F(IndexSnapshotTest, StoppedServerLeavesTheCurrentIndex) {
  const auto loaded = Load();
  ASSERT_THAT(loaded, IsOk());
  EXPECT_EQ(loaded->views.size(), 3U);
  EXPECT_EQ(loaded->index.view_count(), 3U);
  EXPECT_EQ(loaded->file_revision, loaded->revision);
}

TEST_F(IndexSnapshotTest, ResponsesEqualThoseFromTheRecords) {
  const std::string kept = AnswerOfARun();
  EXPECT_EQ(kept, RightAnswer());
}

TEST_F(IndexSnapshotTest, FileIsTheSameFromIndexAndFromRecords) {
  const std::string bytes = ReadBytes(Index());
  RightAnswer();
  EXPECT_EQ(ReadBytes(Index()), bytes);
}

TEST_F(IndexSnapshotTest, DamagedIndexIsRejectedAndRebuilt) {
  const std::string right = RightAnswer();
  const std::string bytes = ReadBytes(Index());
  std::string flipped = bytes;
  flipped[bytes.size() / 2] = static_cast<char>(flipped[bytes.size() / 2] ^ 1);
  for (const std::string& damaged :
       {flipped, bytes.substr(0, bytes.size() - 1), bytes + "x", std::string()}) {
    WriteBytes(Index(), damaged);
    EXPECT_THAT(Load(), StatusIs(absl::StatusCode::kDataLoss, HasSubstr("damaged")));
    EXPECT_EQ(AnswerOfARun(), right);
    EXPECT_EQ(ReadBytes(Index()), bytes);
  }
}

TEST_F(IndexSnapshotTest, IndexOfAnotherDatabaseIsRejected) {
  const std::string right = RightAnswer();
  const std::string own = options_.database;
  options_.database = (folder_.path() / "other").string();
  Start();
  Teach("handle", 3);
  server_.reset();
  std::filesystem::copy_file(Index(), IndexOf(own),
                             std::filesystem::copy_options::overwrite_existing);
  options_.database = own;
  EXPECT_THAT(Load(), StatusIs(kRefused, HasSubstr("another database")));
  EXPECT_EQ(AnswerOfARun(), right);
}

TEST_F(IndexSnapshotTest, IndexOfADivergedCopyIsRejected) {
  const std::filesystem::path copy = CopyOfTheDatabase();
  Start();
  ASSERT_THAT(Upload(ViewOf("wedge", 10, "more")), IsGrpcOk());
  server_.reset();
  const std::string index = ReadBytes(Index());
  options_.database = copy.string();
  Start();
  ASSERT_THAT(Upload(ViewOf("wedge", 20, "more")), IsGrpcOk());
  server_.reset();
  WriteBytes(Index(), index);
  EXPECT_THAT(Load(), StatusIs(kRefused, HasSubstr("another database")));
}

TEST_F(IndexSnapshotTest, NewerIndexIsRejectedByARestoredBackup) {
  const std::filesystem::path backup = CopyOfTheDatabase();
  Start();
  ASSERT_THAT(Upload(ViewOf("wedge", 10, "more")), IsGrpcOk());
  server_.reset();
  WriteBytes(IndexOf(backup), ReadBytes(Index()));
  EXPECT_THAT(Load(backup), StatusIs(kRefused, HasSubstr("another database")));
}

TEST_F(IndexSnapshotTest, IndexOfOtherParametersIsRejected) {
  EXPECT_THAT(Load(options_.database, 0.005), StatusIs(kRefused, HasSubstr("other parameters")));
}

TEST_F(IndexSnapshotTest, OlderIndexIsUpdated) {
  const std::string old = ReadBytes(Index());
  Start();
  for (const char* id : {"turn-0", "turn-1"}) {
    v1::DeleteViewRequest request;
    request.set_name(FlatPoseOf("wedge") + "/views/" + id);
    ASSERT_THAT(Call(&Catalog::DeleteView, request), IsGrpcOk());
  }
  ASSERT_THAT(Upload(ViewOf("wedge", 20, "turn-1")), IsGrpcOk());  // another view of that name
  ASSERT_THAT(Upload(ViewOf("wedge", 30, "new")), IsGrpcOk());
  server_.reset();
  const std::string right = RightAnswer();
  const auto now = Load();
  ASSERT_THAT(now, IsOk());

  WriteBytes(Index(), old);
  const auto loaded = Load();
  ASSERT_THAT(loaded, IsOk());
  EXPECT_EQ(loaded->file_revision, loaded->revision - 4);
  const auto contents = [](const server::LoadedViews& views) {
    std::set<std::pair<std::string, std::string>> out;
    for (const auto& view : views.views) out.emplace(view->name, view->content);
    return out;
  };
  EXPECT_EQ(contents(*loaded), contents(*now));
  EXPECT_EQ(AnswerOfARun(), right);
}

TEST_F(IndexSnapshotTest, IndexFarBehindIsRejected) {
  const std::string old = ReadBytes(Index());
  {
    const auto catalogue = storage::Catalogue::Open(options_.database);
    ASSERT_THAT(catalogue, IsOk());
    const auto view = (*catalogue)->GetView(FlatPoseOf("wedge") + "/views/turn-0");
    ASSERT_THAT(view, IsOk());
    std::vector<storage::NewView> views(server::kMaxChangesBehind + 1, {*view, "cloud"});
    for (std::size_t i = 0; i < views.size(); ++i) {
      views[i].record.set_name(FlatPoseOf("wedge") + "/views/more-" + std::to_string(i));
    }
    ASSERT_THAT((*catalogue)->PutViews(views), IsOk());
  }
  EXPECT_THAT(Load(), StatusIs(kRefused, HasSubstr("20001 changes behind")));
}

TEST_F(IndexSnapshotTest, FailedIndexWriteDoesNotStopTheServer) {
  const std::string right = RightAnswer();
  std::filesystem::remove(Index());
  std::filesystem::create_directory(Index().string() + ".dbtmp");
  EXPECT_EQ(AnswerOfARun(), right);
  EXPECT_THAT(Load(), StatusIs(absl::StatusCode::kNotFound, ::testing::_));
}

}  // namespace
}  // namespace graspdb::testing
