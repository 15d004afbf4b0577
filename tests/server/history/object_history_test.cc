// ObjectHistoryService: deleted objects and earlier revisions.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "graspdb/v1/upload_service.grpc.pb.h"
#include "tests/server/access_fixture.h"
#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr char kWedge[] = "objects/wedge";

template <typename Request>
Request WedgeRequest() {
  Request request;
  request.set_name(kWedge);
  return request;
}

class ObjectHistoryTest : public ServerTest {
 protected:
  void SetUp() override {
    ServerTest::SetUp();
    Teach("wedge", 3);
  }

  void DeleteWedge() {
    auto request = WedgeRequest<v1::DeleteObjectRequest>();
    request.set_force(true);
    ASSERT_THAT(Call(&Catalog::DeleteObject, request), IsGrpcOk());
  }
  grpc::Status Restore(std::int64_t revision) {
    auto request = WedgeRequest<v1::RestoreObjectRequest>();
    request.set_revision(revision);
    return Call(&History::RestoreObject, request);
  }
  // Of a frame of the wedge, without the revision.
  v1::RecognizeResponse See() {
    v1::RecognizeResponse response =
        Answer(RequestOf(Photograph("wedge", {.x = 0.02, .turn_deg = 30}, 5)));
    response.clear_catalog_revision();
    return response;
  }
  std::vector<v1::ObjectRevision> Revisions(int page_size) {
    std::vector<v1::ObjectRevision> out;
    v1::ListObjectRevisionsRequest request;
    request.set_parent(kWedge);
    request.set_page_size(page_size);
    do {
      v1::ListObjectRevisionsResponse page;
      EXPECT_THAT(Call(&History::ListObjectRevisions, request, &page), IsGrpcOk());
      for (const auto& revision : page.revisions()) out.push_back(revision);
      request.set_page_token(page.next_page_token());
    } while (!request.page_token().empty());
    return out;
  }
};

TEST_F(ObjectHistoryTest, UndeleteBringsTheSameRecognition) {
  const v1::RecognizeResponse before = See();
  ASSERT_EQ(before.status(), v1::OK);
  DeleteWedge();
  EXPECT_EQ(See().status(), v1::UNKNOWN_OBJECT);
  Restart();
  EXPECT_EQ(See().status(), v1::UNKNOWN_OBJECT);
  v1::Object object;
  ASSERT_THAT(Call(&History::UndeleteObject, WedgeRequest<v1::UndeleteObjectRequest>(), &object),
              IsGrpcOk());
  EXPECT_EQ(object.display_name(), "The wedge");
  EXPECT_EQ(See().SerializeAsString(), before.SerializeAsString());
  Restart();
  EXPECT_EQ(See().SerializeAsString(), before.SerializeAsString());
}

TEST_F(ObjectHistoryTest, DeletedObjectsAreListedUntilTheyArePurged) {
  EXPECT_EQ(Call(&History::UndeleteObject, WedgeRequest<v1::UndeleteObjectRequest>()).error_code(),
            grpc::StatusCode::NOT_FOUND);
  DeleteWedge();
  v1::ListDeletedObjectsResponse list;
  ASSERT_THAT(Call(&History::ListDeletedObjects, v1::ListDeletedObjectsRequest(), &list),
              IsGrpcOk());
  ASSERT_EQ(list.objects_size(), 1);
  const v1::Object& object = list.objects(0);
  EXPECT_EQ(object.name(), kWedge);
  EXPECT_EQ(object.purge_time().seconds() - object.delete_time().seconds(), 30 * 24 * 3600);
  v1::Object deleted;
  ASSERT_THAT(
      Call(&History::GetDeletedObject, WedgeRequest<v1::GetDeletedObjectRequest>(), &deleted),
      IsGrpcOk());
  EXPECT_EQ(deleted.SerializeAsString(), object.SerializeAsString());

  ASSERT_THAT(Call(&History::PurgeObject, WedgeRequest<v1::PurgeObjectRequest>()), IsGrpcOk());
  EXPECT_EQ(Call(&History::UndeleteObject, WedgeRequest<v1::UndeleteObjectRequest>()).error_code(),
            grpc::StatusCode::NOT_FOUND);
  list.Clear();
  ASSERT_THAT(Call(&History::ListDeletedObjects, v1::ListDeletedObjectsRequest(), &list),
              IsGrpcOk());
  EXPECT_THAT(list.objects(), IsEmpty());
}

TEST_F(ObjectHistoryTest, AnObjectGoesBackToAnEarlierRevision) {
  const std::int64_t revision = Status().catalog_revision();
  const v1::RecognizeResponse before = See();
  for (const char* view : {"v0", "v1", "v2"}) {
    v1::ListViewsRequest list;
    list.set_parent(FlatPoseOf("wedge"));
    v1::ListViewsResponse views;
    ASSERT_THAT(Call(&Catalog::ListViews, list, &views), IsGrpcOk());
    ASSERT_FALSE(views.views().empty()) << view;
    v1::DeleteViewRequest remove;
    remove.set_name(views.views(0).name());
    ASSERT_THAT(Call(&Catalog::DeleteView, remove), IsGrpcOk());
  }
  EXPECT_EQ(See().status(), v1::UNKNOWN_OBJECT);
  ASSERT_THAT(Restore(revision), IsGrpcOk());
  EXPECT_EQ(See().SerializeAsString(), before.SerializeAsString());
  EXPECT_EQ(Restore(0).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Restore(1'000'000).error_code(), grpc::StatusCode::OUT_OF_RANGE);
}

TEST_F(ObjectHistoryTest, ViewsOfEarlierParametersAreDescribedAgain) {
  DeleteWedge();
  options_.normal_radius_m = 0.012;
  Restart();
  ASSERT_THAT(Call(&History::UndeleteObject, WedgeRequest<v1::UndeleteObjectRequest>()),
              IsGrpcOk());
  EXPECT_EQ(See().status(), v1::OK);
  EXPECT_EQ(Status().left_out_record_count(), 0);
}

TEST_F(ObjectHistoryTest, ViewsThatCannotBeDescribedAreLeftOutAndDoNotPreventTheNextStart) {
  DeleteWedge();
  options_.voxel_size_m = 0.1;
  Restart();
  ASSERT_THAT(Call(&History::UndeleteObject, WedgeRequest<v1::UndeleteObjectRequest>()),
              IsGrpcOk());
  const std::int64_t left_out = Status().left_out_record_count();
  EXPECT_GT(left_out, 0);
  Restart();
  EXPECT_EQ(Status().left_out_record_count(), left_out);
  options_.voxel_size_m = 0.003;
  Restart();
  EXPECT_EQ(Status().left_out_record_count(), 0);
  EXPECT_EQ(See().status(), v1::OK);
}

TEST_F(ObjectHistoryTest, HistoryIsPagedWithTheNewestFirst) {
  DeleteWedge();
  for (const int page_size : {1, 2, 100}) {
    const std::vector<v1::ObjectRevision> revisions = Revisions(page_size);
    ASSERT_EQ(revisions.size(), 6U) << "an object, a stable pose, three views, a deletion";
    EXPECT_EQ(revisions[0].revision(), Status().catalog_revision());
    EXPECT_EQ(revisions[0].name(), absl::StrCat(kWedge, "/revisions/", revisions[0].revision()));
    EXPECT_EQ(revisions[0].method(), "DeleteObject");
    EXPECT_EQ(revisions[0].edit_count(), 5);
    EXPECT_EQ(revisions[0].edits(0).kind(), v1::EDIT_KIND_DELETED);
    EXPECT_EQ(revisions[1].method(), "UploadViews");
    EXPECT_EQ(revisions[5].edits(0).name(), kWedge);
    EXPECT_EQ(revisions[5].edits(0).kind(), v1::EDIT_KIND_CREATED);
  }
  v1::ListObjectRevisionsRequest request;
  request.set_parent("objects/none");
  EXPECT_EQ(Call(&History::ListObjectRevisions, request).error_code(), grpc::StatusCode::NOT_FOUND);
  request.set_parent(kWedge);
  request.set_page_token("garbage");
  EXPECT_THAT(Call(&History::ListObjectRevisions, request).error_message(),
              HasSubstr("page_token"));
}

TEST_F(ObjectHistoryTest, AnUploadIntoADeletedObjectFails) {
  const auto stub = v1::UploadService::NewStub(channel_);
  v1::CreateUploadRequest create;
  create.set_upload_id("monday");
  grpc::ClientContext creating;
  v1::Upload upload;
  ASSERT_THAT(stub->CreateUpload(&creating, create, &upload), IsGrpcOk());
  grpc::ClientContext writing;
  const auto stream = stub->WriteUploadViews(&writing);
  const auto write = [&](const std::string& id) {
    v1::WriteUploadViewsRequest request;
    request.set_upload("uploads/monday");
    *request.mutable_view() = ViewOf("wedge", 77, id);
    v1::WriteUploadViewsResponse response;
    EXPECT_TRUE(stream->Write(request) && stream->Read(&response));
    return response;
  };
  EXPECT_FALSE(write("before").has_error());
  DeleteWedge();
  EXPECT_THAT(write("after").error().message(), HasSubstr("no stable pose"));
  stream->WritesDone();
  ASSERT_THAT(stream->Finish(), IsGrpcOk());
  v1::CommitUploadRequest commit;
  commit.set_name("uploads/monday");
  grpc::ClientContext committing;
  EXPECT_EQ(stub->CommitUpload(&committing, commit, &upload).error_code(),
            grpc::StatusCode::FAILED_PRECONDITION);
}

class HistoryAccessTest : public AccessTest {};

TEST_F(HistoryAccessTest, NamesTheIdentityThatMadeAChange) {
  const std::string anna = Add("anna", {v1::ROLE_TEACH, v1::ROLE_READ});
  token_ = anna;
  ASSERT_THAT(CreateObject("wedge"), IsGrpcOk());
  Teach("flange", 1);
  auto remove = WedgeRequest<v1::DeleteObjectRequest>();
  ASSERT_THAT(Call(&Catalog::DeleteObject, remove), IsGrpcOk());
  for (const char* object : {"objects/wedge", "objects/flange"}) {
    v1::ListObjectRevisionsRequest request;
    request.set_parent(object);
    v1::ListObjectRevisionsResponse response;
    ASSERT_THAT(Call(&History::ListObjectRevisions, request, &response), IsGrpcOk());
    ASSERT_GE(response.revisions_size(), 2);
    for (const auto& revision : response.revisions()) EXPECT_EQ(revision.identity(), "anna");
  }
  EXPECT_EQ(Call(&History::PurgeObject, WedgeRequest<v1::PurgeObjectRequest>()).error_code(),
            grpc::StatusCode::PERMISSION_DENIED);
}

}  // namespace
}  // namespace graspdb::testing
