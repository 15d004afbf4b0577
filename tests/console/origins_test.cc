#include <gmock/gmock.h>

#include "console/site.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::console {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::HasSubstr;

constexpr auto kRefused = absl::StatusCode::kPermissionDenied;

TEST(Origins, ALoopbackAddressHasItsOtherNames) {
  const Origins origins("127.0.0.1", 8080, {}, false);
  for (const char* host : {"127.0.0.1:8080", "localhost:8080", "LocalHost:8080", "[::1]:8080"}) {
    EXPECT_THAT(origins.CheckHost(host), IsOk()) << host;
  }
  for (const char* host : {"", "localhost", "127.0.0.1", "localhost:80", "evil.example:8080",
                           "127.0.0.1:8080.evil.example", "x127.0.0.1:8080", "localhost:8080 ",
                           "user@localhost:8080", "127.0.0.2:8080", "0.0.0.0:8080"}) {
    EXPECT_THAT(origins.CheckHost(host), StatusIs(kRefused, HasSubstr("open it as"))) << host;
  }
}

TEST(Origins, BrowsersLeaveOutTheUsualPort) {
  EXPECT_THAT(Origins("10.3.0.1", 443, {}, true).CheckHost("10.3.0.1"), IsOk());
  EXPECT_THAT(Origins("10.3.0.1", 80, {}, false).CheckHost("10.3.0.1"), IsOk());
  EXPECT_FALSE(Origins("10.3.0.1", 443, {}, false).CheckHost("10.3.0.1").ok());
  EXPECT_FALSE(Origins("10.3.0.1", 8443, {}, true).CheckHost("localhost:8443").ok());
}

TEST(Origins, FurtherNamesAreComparedAsTheyAre) {
  const Origins origins("0.0.0.0", 8080, {"Console.plant"}, true);
  EXPECT_THAT(origins.CheckHost("console.plant"), IsOk());
  EXPECT_FALSE(origins.CheckHost("console.plant:8080").ok());
  EXPECT_THAT(origins.CheckCall("https://console.plant", "same-origin"), IsOk());
  EXPECT_FALSE(origins.CheckCall("http://console.plant", "same-origin").ok());
}

TEST(Origins, CallsAreFromTheOwnPageOrFromNone) {
  const Origins origins("127.0.0.1", 8080, {}, false);
  EXPECT_THAT(origins.CheckCall("", ""), IsOk());
  EXPECT_THAT(origins.CheckCall("http://localhost:8080", "same-origin"), IsOk());
  EXPECT_THAT(origins.CheckCall("", "none"), IsOk());
  for (const char* origin :
       {"null", "https://localhost:8080", "http://localhost:9090", "http://evil.example",
        "http://localhost:8080.evil.example", "http://localhost:8080/"}) {
    EXPECT_THAT(origins.CheckCall(origin, ""), StatusIs(kRefused, HasSubstr("other sites")))
        << origin;
  }
  for (const char* site : {"cross-site", "same-site", "x"}) {
    EXPECT_THAT(origins.CheckCall("", site), StatusIs(kRefused, HasSubstr("other sites"))) << site;
  }
}

}  // namespace
}  // namespace graspdb::console
