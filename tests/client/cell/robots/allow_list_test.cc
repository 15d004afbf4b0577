#include <gmock/gmock.h>

#include "client/cell/robots/robot_server.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;

bool Allows(const std::vector<std::string>& networks, const std::string& address) {
  const absl::StatusOr<AllowList> list = AllowList::Parse(networks);
  EXPECT_THAT(list, IsOk());
  return list.ok() && list->Allows(asio::ip::make_address(address));
}

TEST(AllowListTest, AllowsTheAddressesOfItsNetworks) {
  const std::vector<std::string> networks = {"10.3.0.0/24", "10.4.0.7", "fd00:3::/32", "fe80::1"};
  for (const char* robot :
       {"10.3.0.0", "10.3.0.255", "10.4.0.7", "fd00:3:1::9", "fe80::1", "::ffff:10.3.0.9"}) {
    EXPECT_TRUE(Allows(networks, robot)) << robot;
  }
  for (const char* robot : {"10.3.1.0", "10.2.255.255", "10.4.0.8", "127.0.0.1", "fd00:4::1",
                            "fe80::2", "::ffff:10.4.0.8", "::10.3.0.9"}) {
    EXPECT_FALSE(Allows(networks, robot)) << robot;
  }
}

TEST(AllowListTest, WithoutNetworksAllAreAllowed) {
  EXPECT_TRUE(Allows({}, "203.0.113.9"));
  EXPECT_TRUE(Allows({"0.0.0.0/0", "::/0"}, "203.0.113.9"));
}

TEST(AllowListTest, OtherTextsAreRejected) {
  for (const char* text : {"", "robot", "10.3.0.0/33", "10.3.0/24", "10.3.0.0/", "10.3.0.0/x",
                           "10.3.0.0/24/8", "fd00::/129", "fd00::/-1", " 10.3.0.1"}) {
    EXPECT_THAT(AllowList::Parse({text}), StatusIs(absl::StatusCode::kInvalidArgument,
                                                   ::testing::HasSubstr("--robots-allow")))
        << text;
  }
}

}  // namespace
}  // namespace graspdb::client
