#include "program/connections/peer_address.h"

#include <gtest/gtest.h>

namespace graspdb {
namespace {

TEST(NetworkOfPeerTest, AddressesOfOneNetworkAreOneCaller) {
  EXPECT_EQ(NetworkOfPeer("ipv4:10.3.0.7:41522"), "ipv4:10.3.0.7");
  EXPECT_EQ(NetworkOfPeer("ipv6:[2001:db8:1:2::7]:50"), "ipv6:2001:db8:1:2::");
  EXPECT_EQ(NetworkOfPeer("ipv6:%5B2001:db8:1:2:9::8%5D:51"), "ipv6:2001:db8:1:2::");
  EXPECT_NE(NetworkOfPeer("ipv6:[2001:db8:1:3::7]:50"), "ipv6:2001:db8:1:2::");
  EXPECT_EQ(NetworkOfPeer("unix:"), "unix");
}

}  // namespace
}  // namespace graspdb
