// Following the catalogue: ChangeService.
#include <gmock/gmock.h>

#include <filesystem>
#include <thread>

#include "graspdb/v1/change_service.grpc.pb.h"
#include "storage/backups/backups.h"
#include "storage/catalogue/catalogue.h"
#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

// A running call.
class Watcher {
 public:
  Watcher(v1::ChangeService::Stub& stub, const v1::WatchCatalogRequest& request)
      : reader_(stub.WatchCatalog(&context_, request)) {}
  ~Watcher() { End(); }

  // Whether there is a first response.
  bool IsRunning() {
    v1::WatchCatalogResponse response;
    return reader_->Read(&response);
  }
  // The next response; an empty one after the end.
  v1::WatchCatalogResponse Next() {
    v1::WatchCatalogResponse response;
    if (!reader_->Read(&response)) response.Clear();
    return response;
  }
  // The next response that is no heartbeat.
  v1::WatchCatalogResponse NextChange() {
    for (;;) {
      v1::WatchCatalogResponse response = Next();
      if (response.changes_size() > 0 || response.catalog_revision() == 0) return response;
    }
  }
  grpc::Status End() {
    if (ended_) return grpc::Status::OK;
    context_.TryCancel();
    return Finish();
  }
  grpc::Status Finish() {
    ended_ = true;
    return reader_->Finish();
  }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReader<v1::WatchCatalogResponse>> reader_;
  bool ended_ = false;
};

class ChangesTest : public ServerTest {
 protected:
  void SetUp() override {
    ServerTest::SetUp();
    Connect();
  }
  void Connect() { stub_ = v1::ChangeService::NewStub(channel_); }

  // Restores a backup of the database, and starts the server on it.
  void RestoreABackup() {
    server_.reset();
    const std::filesystem::path folder = folder_.path() / "backups";
    std::filesystem::create_directory(folder);
    storage::Backups backups(folder.string());
    {
      const auto catalogue = storage::Catalogue::Open(options_.database);
      ASSERT_TRUE(catalogue.ok()) << catalogue.status();
      ASSERT_TRUE(backups.Create(**catalogue).ok());
    }
    options_.database = (folder_.path() / "restored").string();
    ASSERT_TRUE(backups.Restore(1, options_.database).ok());
    Restart();
    Connect();
  }

  static v1::WatchCatalogRequest After(std::int64_t revision, bool records = false) {
    v1::WatchCatalogRequest request;
    request.set_after_revision(revision);
    request.set_include_records(records);
    return request;
  }

  std::unique_ptr<v1::ChangeService::Stub> stub_;
};

TEST_F(ChangesTest, PastChangesComeInOrderThenNewOnesAsTheyHappen) {
  Declare("wedge");
  ASSERT_THAT(Upload(ViewOf("wedge", 0, "a")), IsGrpcOk());
  Watcher watcher(*stub_, After(0));
  v1::WatchCatalogResponse change = watcher.NextChange();
  EXPECT_EQ(change.catalog_revision(), 1);
  EXPECT_TRUE(change.has_change_time());
  EXPECT_EQ(change.changes(0).name(), "objects/wedge");
  EXPECT_EQ(change.changes(0).kind(), v1::CHANGE_KIND_WRITTEN);
  EXPECT_FALSE(change.changes(0).has_object());
  EXPECT_EQ(watcher.NextChange().changes(0).name(), FlatPoseOf("wedge"));
  change = watcher.NextChange();
  ASSERT_EQ(change.changes_size(), 1);
  EXPECT_EQ(change.changes(0).name(), FlatPoseOf("wedge") + "/views/a");

  v1::DeleteViewRequest request;
  request.set_name(FlatPoseOf("wedge") + "/views/a");
  ASSERT_THAT(Call(&Catalog::DeleteView, request), IsGrpcOk());
  change = watcher.NextChange();
  EXPECT_EQ(change.catalog_revision(), Status().catalog_revision());
  EXPECT_EQ(change.changes(0).kind(), v1::CHANGE_KIND_DELETED);
  EXPECT_EQ(watcher.End().error_code(), grpc::StatusCode::CANCELLED);
}

TEST_F(ChangesTest, RecordsAreSentOnRequest) {
  Declare("wedge");
  Watcher watcher(*stub_, After(0, true));
  EXPECT_EQ(watcher.NextChange().changes(0).object().name(), "objects/wedge");
  EXPECT_GT(watcher.NextChange().changes(0).stable_pose().grasps_size(), 0);
}

TEST_F(ChangesTest, HeartbeatsHaveTheCurrentRevision) {
  Declare("wedge");
  v1::WatchCatalogRequest request;
  request.set_heartbeat_s(1);
  Watcher watcher(*stub_, request);
  for (int i = 0; i < 2; ++i) {
    const v1::WatchCatalogResponse alive = watcher.Next();
    EXPECT_EQ(alive.catalog_revision(), Status().catalog_revision());
    EXPECT_EQ(alive.changes_size(), 0);
    EXPECT_FALSE(alive.has_change_time());
  }
}

TEST_F(ChangesTest, ChangesThatAreNoLongerKeptAreOutOfRange) {
  options_.keep_changes = 2;
  Restart();
  Connect();
  for (const char* id : {"a", "b", "c", "d"}) ASSERT_THAT(CreateObject(id), IsGrpcOk());
  ExpectError(Watcher(*stub_, After(0)).Finish(), grpc::StatusCode::OUT_OF_RANGE, "read all");
  Watcher watcher(*stub_, After(2));
  EXPECT_EQ(watcher.NextChange().changes(0).name(), "objects/c");
  ExpectError(Watcher(*stub_, After(5)).Finish(), grpc::StatusCode::OUT_OF_RANGE, "revision 4");
}

TEST_F(ChangesTest, EveryResponseHasTheIdOfTheCatalogue) {
  Declare("wedge");
  const std::string id = Status().catalog_id();
  EXPECT_FALSE(id.empty());
  Restart();
  Connect();
  EXPECT_EQ(Status().catalog_id(), id);
  v1::WatchCatalogRequest request = After(0);
  request.set_catalog_id(id);
  Watcher watcher(*stub_, request);
  for (const int changes : {1, 1, 0}) {
    const v1::WatchCatalogResponse response = watcher.Next();
    EXPECT_EQ(response.changes_size(), changes);
    EXPECT_EQ(response.catalog_id(), id);
  }
}

TEST_F(ChangesTest, AnotherCatalogueIsOutOfRange) {
  v1::WatchCatalogRequest request;
  request.set_catalog_id("another");
  ExpectError(Watcher(*stub_, request).Finish(), grpc::StatusCode::OUT_OF_RANGE, "read all");
  request.set_after_revision(0);
  ExpectError(Watcher(*stub_, request).Finish(), grpc::StatusCode::OUT_OF_RANGE, "read all");
}

TEST_F(ChangesTest, AfterARestoreRevisionsOfTheOriginalAreOutOfRange) {
  ASSERT_THAT(CreateObject("a"), IsGrpcOk());
  const std::string original = Status().catalog_id();
  ASSERT_NO_FATAL_FAILURE(RestoreABackup());
  const std::string restored = Status().catalog_id();
  EXPECT_NE(restored, original);
  EXPECT_EQ(Status().catalog_revision(), 1);
  // The original went on with other changes of these revisions.
  for (const char* id : {"b", "c"}) ASSERT_THAT(CreateObject(id), IsGrpcOk());
  v1::WatchCatalogRequest request = After(2);
  request.set_catalog_id(original);
  ExpectError(Watcher(*stub_, request).Finish(), grpc::StatusCode::OUT_OF_RANGE, "read all");
  request.set_catalog_id(restored);
  Watcher watcher(*stub_, request);
  const v1::WatchCatalogResponse change = watcher.NextChange();
  EXPECT_EQ(change.catalog_revision(), 3);
  ASSERT_EQ(change.changes_size(), 1);
  EXPECT_EQ(change.changes(0).name(), "objects/c");
}

TEST_F(ChangesTest, ALargeChangeComesInParts) {
  v1::UploadViewsRequest view = ViewOf("wedge", 0, "");
  Declare("wedge");
  std::vector<v1::UploadViewsRequest> views;
  const int count = 600;
  for (int i = 0; i < count; ++i) {
    view.set_view_id(std::to_string(i));
    views.push_back(view);
  }
  v1::UploadViewsResponse uploaded;
  ASSERT_THAT(Upload(views, &uploaded), IsGrpcOk());
  const std::int64_t before = Status().catalog_revision();
  v1::DeleteObjectRequest request;
  request.set_name("objects/wedge");
  request.set_force(true);
  ASSERT_THAT(Call(&Catalog::DeleteObject, request), IsGrpcOk());
  Watcher watcher(*stub_, After(before));
  const v1::WatchCatalogResponse first = watcher.NextChange();
  EXPECT_TRUE(first.continued());
  const v1::WatchCatalogResponse second = watcher.NextChange();
  EXPECT_FALSE(second.continued());
  EXPECT_EQ(second.catalog_revision(), first.catalog_revision());
  EXPECT_EQ(first.changes_size() + second.changes_size(), count + 2);
}

TEST_F(ChangesTest, WatchersLeaveThreadsForOtherCalls) {
  std::vector<std::unique_ptr<Watcher>> watchers;
  grpc::Status refused;
  while (refused.ok() && watchers.size() < 300) {
    auto watcher = std::make_unique<Watcher>(*stub_, v1::WatchCatalogRequest());
    if (watcher->IsRunning()) {
      watchers.push_back(std::move(watcher));
    } else {
      refused = watcher->Finish();
    }
  }
  EXPECT_GE(watchers.size(), 5U);
  ExpectError(refused, grpc::StatusCode::RESOURCE_EXHAUSTED, "watchers");
  EXPECT_THAT(CreateObject("mug"), IsGrpcOk());
  watchers.pop_back();
  while (!Watcher(*stub_, v1::WatchCatalogRequest()).IsRunning()) {
  }
}

TEST_F(ChangesTest, AWatcherDoesNotHoldUpAShutdown) {
  options_.drain_s = 60;
  Restart();
  Connect();
  Watcher watcher(*stub_, After(0));
  EXPECT_EQ(watcher.Next().catalog_revision(), 0);
  std::thread stop([&] { server_->Drain(); });
  const grpc::Status ended = watcher.Finish();
  stop.join();
  EXPECT_EQ(ended.error_code(), grpc::StatusCode::UNAVAILABLE);
}

TEST_F(ChangesTest, AnInvalidHeartbeatIsRejected) {
  for (const double seconds : {0.0, -1.0, 4000.0, std::nan("")}) {
    v1::WatchCatalogRequest request;
    request.set_heartbeat_s(seconds);
    ExpectBadField(Watcher(*stub_, request).Finish(), "heartbeat_s", "1 to 3600");
  }
}

}  // namespace
}  // namespace graspdb::testing
