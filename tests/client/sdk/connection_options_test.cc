// Options with which no client can connect.
#include <gmock/gmock.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "client/sdk/client.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::StatusIs;
using ::testing::HasSubstr;

constexpr auto kWrongFile = absl::StatusCode::kFailedPrecondition;
// No server listens here.
constexpr char kNoServer[] = "127.0.0.1:1";

class ConnectionOptionsTest : public ::testing::Test {
 protected:
  static absl::Status Call(const SecurityOptions& security, const std::string& server = kNoServer) {
    return Client({.server = server, .retry = false, .security = security})
        .GetCatalogStatus()
        .status();
  }

  const files::TemporaryFolder folder_;
  const std::string pem_ = folder_.Write("some.pem", "-----BEGIN\n").string();
};

TEST_F(ConnectionOptionsTest, HalfAPairIsTheErrorOfEveryCall) {
  for (const SecurityOptions& half :
       {SecurityOptions{.ca = pem_, .cert = pem_}, SecurityOptions{.cert = pem_},
        SecurityOptions{.key = pem_}}) {
    Client client({.server = kNoServer, .security = half});
    const auto refuses = StatusIs(absl::StatusCode::kInvalidArgument,
                                  HasSubstr("--cert and --key belong together; give both"));
    EXPECT_THAT(client.GetCatalogStatus(), refuses);
    EXPECT_THAT(client.WatchCatalog({}, [](const auto&) { return absl::OkStatus(); }), refuses);
    EXPECT_THAT(client.UploadViews([](auto*) -> absl::StatusOr<bool> { return false; }), refuses);
    EXPECT_THAT(client.WriteUploadViews([](auto*) -> absl::StatusOr<bool> { return false; },
                                        [](const auto&) {}),
                refuses);
  }
}

TEST_F(ConnectionOptionsTest, AServerNeedsAPort) {
  for (const char* server : {"", "127.0.0.1", "localhost", "localhost:", ":50051", "[::1]", "::1",
                             "fe80::1:50051", "2001:db8:0:0:0:0:0:1", "127.0.0.1:0",
                             "127.0.0.1:65536", "localhost:x", "http://127.0.0.1:50051"}) {
    EXPECT_THAT(Call({}, server),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("is not HOST:PORT; give")))
        << server;
  }
  for (const char* server :
       {"127.0.0.1:1", "[::1]:1", "ipv4:127.0.0.1:1", "ipv4:///127.0.0.1:1", "unix:/none/socket"}) {
    EXPECT_THAT(Call({}, server), StatusIs(absl::StatusCode::kUnavailable)) << server;
  }
}

TEST_F(ConnectionOptionsTest, FoldersAndEmptyFilesAreReported) {
  const std::string empty = folder_.Write("empty", "").string();
  for (const std::string& file : {empty, folder_.path().string()}) {
    const auto refuses = [&](const std::string& flag) {
      return StatusIs(kWrongFile, HasSubstr(absl::StrCat(flag, " ", file, " is ")));
    };
    EXPECT_THAT(Call({.ca = file}), refuses("--ca"));
    EXPECT_THAT(Call({.ca = pem_, .cert = file, .key = pem_}), refuses("--cert"));
    EXPECT_THAT(Call({.ca = pem_, .cert = pem_, .key = file}), refuses("--key"));
  }
}

// Also where the server is open to all, which would not miss the token.
TEST_F(ConnectionOptionsTest, AFileWithoutTokenIsReportedAtOnce) {
  const std::string missing = (folder_.path() / "missing").string();
  EXPECT_THAT(Call({.token_file = missing}),
              StatusIs(kWrongFile, HasSubstr("cannot read --token-file " + missing +
                                             " (No such file or directory); give")));
  EXPECT_THAT(Call({.token_file = folder_.path().string()}),
              StatusIs(kWrongFile, HasSubstr("(Is a directory)")));
  const std::string empty = folder_.Write("empty", "").string();
  EXPECT_THAT(Call({.token_file = empty}),
              StatusIs(kWrongFile, HasSubstr(empty + " has no token in its first line")));
}

TEST_F(ConnectionOptionsTest, ATokenThatIsWrittenLaterIsUsed) {
  const std::string file = folder_.Write("token", "").string();
  Client client({.server = "127.0.0.1:1", .retry = false, .security = {.token_file = file}});
  EXPECT_THAT(client.GetCatalogStatus().status(), StatusIs(kWrongFile));
  folder_.Write("token", "abc\n");
  EXPECT_THAT(client.GetCatalogStatus().status(), StatusIs(absl::StatusCode::kUnavailable));
}

}  // namespace
}  // namespace graspdb::client
