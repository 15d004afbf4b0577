// Stable poses that may be confused.
#include <gmock/gmock.h>

#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class LookAlikesTest : public ServerTest {
 protected:
  v1::FindLookAlikesResponse Find(const std::string& object) {
    v1::FindLookAlikesRequest request;
    request.set_object(object);
    v1::FindLookAlikesResponse response;
    EXPECT_THAT(Call(&Recognition::FindLookAlikes, request, &response), IsGrpcOk());
    return response;
  }
};

TEST_F(LookAlikesTest, EmptyCatalogueHasNoLookAlikes) {
  const v1::FindLookAlikesResponse found = Find("");
  EXPECT_THAT(found.symmetries(), IsEmpty());
  EXPECT_THAT(found.pairs(), IsEmpty());
}

TEST_F(LookAlikesTest, SymmetriesAreReturnedWithTheDeclaredOrder) {
  Teach("flange", 12);
  Teach("wedge", 12);
  const v1::FindLookAlikesResponse found = Find("");
  ASSERT_THAT(found.symmetries(), SizeIs(1));
  EXPECT_EQ(found.symmetries(0).stable_pose(), FlatPoseOf("flange"));
  EXPECT_EQ(found.symmetries(0).declared_order(), Part("flange").symmetry_order);
  EXPECT_NE(found.symmetries(0).found_order(), 1);
  EXPECT_THAT(found.pairs(), IsEmpty());
  EXPECT_GT(found.catalog_revision(), 0);
  EXPECT_THAT(Find("objects/wedge").symmetries(), IsEmpty());
}

TEST_F(LookAlikesTest, AnObjectThatIsNotThereIsNotFound) {
  v1::FindLookAlikesRequest request;
  request.set_object("objects/missing");
  v1::FindLookAlikesResponse response;
  const grpc::Status status = Call(&Recognition::FindLookAlikes, request, &response);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(status.error_message(), HasSubstr("objects/missing"));
}

}  // namespace
}  // namespace graspdb::testing
