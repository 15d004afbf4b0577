// Objects through the CatalogService.
#include <gmock/gmock.h>

#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class ObjectsTest : public ServerTest {
 protected:
  grpc::Status Get(const std::string& name, v1::Object* object) {
    v1::GetObjectRequest request;
    request.set_name(name);
    return Call(&Catalog::GetObject, request, object);
  }

  grpc::Status Update(const v1::Object& object, const std::vector<std::string>& mask,
                      v1::Object* updated) {
    v1::UpdateObjectRequest request;
    *request.mutable_object() = object;
    for (const std::string& path : mask) request.mutable_update_mask()->add_paths(path);
    return Call(&Catalog::UpdateObject, request, updated);
  }

  grpc::Status Delete(const std::string& name, bool force, const std::string& etag = "") {
    v1::DeleteObjectRequest request;
    request.set_name(name);
    request.set_force(force);
    request.set_etag(etag);
    return Call(&Catalog::DeleteObject, request);
  }

  grpc::Status List(int page_size, const std::string& token, v1::ListObjectsResponse* page) {
    v1::ListObjectsRequest request;
    request.set_page_size(page_size);
    request.set_page_token(token);
    page->Clear();
    return Call(&Catalog::ListObjects, request, page);
  }
};

TEST_F(ObjectsTest, ACreatedObjectIsReadBack) {
  v1::Object made;
  ASSERT_THAT(CreateObject("mug", &made), IsGrpcOk());
  EXPECT_EQ(made.name(), "objects/mug");
  EXPECT_EQ(made.display_name(), "The mug");
  EXPECT_NE(made.etag(), "");
  EXPECT_GT(made.create_time().seconds(), 0);
  v1::Object read;
  ASSERT_THAT(Get("objects/mug", &read), IsGrpcOk());
  EXPECT_EQ(read.SerializeAsString(), made.SerializeAsString());
}

TEST_F(ObjectsTest, TheNameInTheObjectIsIgnoredOnCreation) {
  v1::CreateObjectRequest request;
  request.set_object_id("mug");
  request.mutable_object()->set_name("objects/other");
  v1::Object made;
  ASSERT_THAT(Call(&Catalog::CreateObject, request, &made), IsGrpcOk());
  EXPECT_EQ(made.name(), "objects/mug");
}

TEST_F(ObjectsTest, ATakenIdIsAnErrorAndChangesNothing) {
  ASSERT_THAT(CreateObject("mug"), IsGrpcOk());
  ExpectError(CreateObject("mug"), grpc::StatusCode::ALREADY_EXISTS, "objects/mug");
  EXPECT_EQ(Status().catalog_revision(), 1);
}

TEST_F(ObjectsTest, MissingObjectIsNotFound) {
  v1::Object object;
  ExpectError(Get("objects/mug", &object), grpc::StatusCode::NOT_FOUND, "objects/mug");
  object.set_name("objects/mug");
  ExpectError(Update(object, {}, &object), grpc::StatusCode::NOT_FOUND, "objects/mug");
  ExpectError(Delete("objects/mug", false), grpc::StatusCode::NOT_FOUND, "objects/mug");
}

TEST_F(ObjectsTest, AnUpdateChangesTheFieldAndTheEtag) {
  v1::Object object;
  ASSERT_THAT(CreateObject("mug", &object), IsGrpcOk());
  const std::string etag = object.etag();
  object.set_display_name("Cup");
  v1::Object updated;
  ASSERT_THAT(Update(object, {"display_name"}, &updated), IsGrpcOk());
  EXPECT_EQ(updated.display_name(), "Cup");
  EXPECT_NE(updated.etag(), etag);
  EXPECT_EQ(updated.create_time().SerializeAsString(), object.create_time().SerializeAsString());
}

TEST_F(ObjectsTest, AnEmptyMaskMeansAllFieldsThatMayChange) {
  v1::Object object;
  ASSERT_THAT(CreateObject("mug", &object), IsGrpcOk());
  v1::Object bare;
  bare.set_name("objects/mug");
  v1::Object updated;
  ASSERT_THAT(Update(bare, {}, &updated), IsGrpcOk());
  EXPECT_EQ(updated.display_name(), "");
  EXPECT_EQ(updated.create_time().SerializeAsString(), object.create_time().SerializeAsString());
}

TEST_F(ObjectsTest, AStaleEtagAbortsTheWrite) {
  v1::Object object;
  ASSERT_THAT(CreateObject("mug", &object), IsGrpcOk());
  const v1::Object stale = object;
  ASSERT_THAT(Update(stale, {}, &object), IsGrpcOk());
  v1::Object ignored;
  ExpectError(Update(stale, {}, &ignored), grpc::StatusCode::ABORTED, "objects/mug");
  ExpectError(Delete("objects/mug", false, stale.etag()), grpc::StatusCode::ABORTED, "objects/mug");
  EXPECT_THAT(Delete("objects/mug", false, object.etag()), IsGrpcOk());
}

TEST_F(ObjectsTest, AnObjectWithStablePosesIsDeletedOnlyByForce) {
  Declare("wedge");
  ExpectError(Delete("objects/wedge", false), grpc::StatusCode::FAILED_PRECONDITION, "force");
  EXPECT_EQ(Status().stable_pose_count(), 1);
  ASSERT_THAT(Delete("objects/wedge", true), IsGrpcOk());
  EXPECT_EQ(Status().object_count(), 0);
  EXPECT_EQ(Status().stable_pose_count(), 0);
}

TEST_F(ObjectsTest, PagesFollowEachOtherInTheOrderOfNames) {
  for (const char* id : {"e", "a", "d", "b", "c"}) ASSERT_THAT(CreateObject(id), IsGrpcOk());
  std::vector<std::string> names;
  std::vector<int> sizes;
  v1::ListObjectsResponse page;
  do {
    ASSERT_THAT(List(2, page.next_page_token(), &page), IsGrpcOk());
    sizes.push_back(page.objects_size());
    for (const v1::Object& object : page.objects()) names.push_back(object.name());
  } while (!page.next_page_token().empty());
  EXPECT_THAT(sizes, ElementsAre(2, 2, 1));
  EXPECT_THAT(names, ElementsAre("objects/a", "objects/b", "objects/c", "objects/d", "objects/e"));
}

TEST_F(ObjectsTest, AListThatEndsWithThePageHasNoNextPage) {
  for (const char* id : {"a", "b"}) ASSERT_THAT(CreateObject(id), IsGrpcOk());
  v1::ListObjectsResponse page;
  ASSERT_THAT(List(2, "", &page), IsGrpcOk());
  EXPECT_EQ(page.objects_size(), 2);
  EXPECT_EQ(page.next_page_token(), "");
}

TEST_F(ObjectsTest, ListContinuesAfterADeletedObject) {
  for (const char* id : {"a", "b", "c"}) ASSERT_THAT(CreateObject(id), IsGrpcOk());
  v1::ListObjectsResponse page;
  ASSERT_THAT(List(2, "", &page), IsGrpcOk());
  ASSERT_THAT(Delete("objects/b", false), IsGrpcOk());
  ASSERT_THAT(List(2, page.next_page_token(), &page), IsGrpcOk());
  ASSERT_EQ(page.objects_size(), 1);
  EXPECT_EQ(page.objects(0).name(), "objects/c");
}

TEST_F(ObjectsTest, AnEmptyCatalogueHasOneEmptyPage) {
  v1::ListObjectsResponse page;
  ASSERT_THAT(List(0, "", &page), IsGrpcOk());
  EXPECT_THAT(page.objects(), IsEmpty());
  EXPECT_EQ(page.next_page_token(), "");
}

TEST_F(ObjectsTest, ObjectsSurviveARestart) {
  v1::Object made;
  ASSERT_THAT(CreateObject("mug", &made), IsGrpcOk());
  Restart();
  v1::Object read;
  ASSERT_THAT(Get("objects/mug", &read), IsGrpcOk());
  EXPECT_EQ(read.SerializeAsString(), made.SerializeAsString());
  EXPECT_EQ(Status().catalog_revision(), 1);
}

}  // namespace
}  // namespace graspdb::testing
