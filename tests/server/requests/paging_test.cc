#include <gmock/gmock.h>

#include "server/base/errors.h"
#include "server/requests/respond.h"
#include "tests/server/error_details.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::server {
namespace {

using testing::ExpectBadField;

TEST(Paging, SizesAreBounded) {
  EXPECT_EQ(PageSize(0).value(), 100U);
  EXPECT_EQ(PageSize(1).value(), 1U);
  EXPECT_EQ(PageSize(1000).value(), 1000U);
  EXPECT_EQ(PageSize(1001).value(), 1000U);
  EXPECT_EQ(PageSize(2147483647).value(), 1000U);
  ExpectBadField(ToGrpcStatus(PageSize(-1).status()), "page_size", "must not be negative");
}

TEST(Paging, TokenRoundTrips) {
  const std::string name = "objects/a.b-c_d/stablePoses/0/views/zz";
  const std::string token = PageTokenAfter(name);
  EXPECT_EQ(token.find('/'), std::string::npos);
  EXPECT_EQ(NameFromPageToken(token, "objects/a.b-c_d/stablePoses/0/views/").value(), name);
}

TEST(Paging, NoTokenMeansTheFirstPage) { EXPECT_EQ(NameFromPageToken("", "objects/").value(), ""); }

TEST(Paging, OnlyTokensOfTheListAreAccepted) {
  for (const std::string& token : {std::string("?!"), std::string("A"), std::string("Zm9v"),
                                   PageTokenAfter("cells/a"), PageTokenAfter("objects/a") + "\n"}) {
    ExpectBadField(ToGrpcStatus(NameFromPageToken(token, "objects/").status()), "page_token",
                   "not a page token of this list");
  }
}

}  // namespace
}  // namespace graspdb::server
