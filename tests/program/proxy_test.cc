#include "program/connections/proxy.h"

#include <gmock/gmock.h>

#include "tests/testing/scoped_variable.h"

namespace graspdb {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::NoProxy;
using ::testing::Not;
using testing::ScopedVariable;

TEST(Proxy, TargetsOnThisMachineAreLocal) {
  for (const char* target :
       {"127.0.0.1:50051", "localhost:50051", "[::1]:50051", "[::1]", "ipv4:127.0.0.1:1",
        "ipv6:[::1]:1", "dns:///localhost:1", "unix:/run/graspdb.sock", "unix-abstract:graspdb"}) {
    EXPECT_TRUE(IsLocalTarget(target)) << target;
  }
  for (const char* target :
       {"10.0.0.1:50051", "127.example.org:50051", "dns:///example.org:1", "[2001:db8::1]:1", ""}) {
    EXPECT_FALSE(IsLocalTarget(target)) << target;
  }
}

TEST(Proxy, TheVariableIsNamedWithoutThePassword) {
  const NoProxy no_proxy;
  const ScopedVariable http("http_proxy", "http://user:secret@proxy.plant:3128");
  const ScopedVariable none("no_proxy", "localhost");
  EXPECT_THAT(ProxyAdvice("server.plant:50051"),
              AllOf(HasSubstr("http_proxy is set"), HasSubstr("proxy.plant:3128"),
                    HasSubstr("add server.plant to no_proxy"), Not(HasSubstr("secret"))));
  EXPECT_EQ(ProxyAdvice("127.0.0.1:50051"), "");
  const ScopedVariable first("grpc_proxy", "http://other.plant:3128");
  EXPECT_THAT(ProxyAdvice("server.plant:50051"), HasSubstr("grpc_proxy is set"));
}

TEST(Proxy, AnEmptyVariableIsSet) {
  const NoProxy no_proxy;
  const ScopedVariable http("http_proxy", "http://proxy.plant:3128");
  {
    const ScopedVariable first("grpc_proxy", "");
    EXPECT_EQ(ProxyAdvice("server.plant:50051"), "");
  }
  const ScopedVariable excepted("no_proxy", ".plant");
  EXPECT_EQ(ProxyAdvice("server.plant:50051"), "");
  const ScopedVariable stronger("no_grpc_proxy", "");
  EXPECT_THAT(ProxyAdvice("server.plant:50051"), HasSubstr("http_proxy"));
}

TEST(Proxy, ExceptedHostsUseNone) {
  const NoProxy no_proxy;
  const ScopedVariable http("http_proxy", "http://proxy.plant:3128");
  const ScopedVariable excepted("no_proxy", "a.example, .plant");
  EXPECT_EQ(ProxyAdvice("server.plant:50051"), "");
  EXPECT_THAT(ProxyAdvice("server.example:50051"), HasSubstr("http_proxy"));
  const ScopedVariable stronger("no_grpc_proxy", "b.example");
  EXPECT_THAT(ProxyAdvice("server.plant:50051"), HasSubstr("http_proxy"));
}

}  // namespace
}  // namespace graspdb
