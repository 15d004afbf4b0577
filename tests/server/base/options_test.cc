#include "server/base/options.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <vector>

#include "server/access/tls.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::server {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

ParsedOptions Parse(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "graspdb-server");
  std::vector<char*> argv;
  argv.reserve(arguments.size());
  for (std::string& argument : arguments) argv.push_back(argument.data());
  return ParseOptions(static_cast<int>(argv.size()), argv.data());
}

// An environment variable for the duration of a test.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) { setenv(name, value, 1); }
  ~Variable() { unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

TEST(Options, SecurityFlagsAreRead) {
  const ServerOptions options =
      Parse({"--db", "/d", "--tls-cert", "c.pem", "--tls-key", "k.pem", "--tls-client-ca", "a.pem",
             "--require-client-cert", "--identities", "i.jsonl", "--audit-log", "l.jsonl",
             "--audit-log-mib", "7"})
          .options;
  EXPECT_EQ(options.tls.cert, "c.pem");
  EXPECT_EQ(options.tls.key, "k.pem");
  EXPECT_EQ(options.tls.client_ca, "a.pem");
  EXPECT_TRUE(options.tls.require_client_cert);
  EXPECT_EQ(options.identities, "i.jsonl");
  EXPECT_EQ(options.audit_log, "l.jsonl");
  EXPECT_EQ(options.audit_log_mib, 7);
}

TEST(Options, TlsFlagsBelongTogether) {
  const auto check = [](const TlsFiles& files) { return CheckTlsFiles(files); };
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT(check({}), IsOk());
  EXPECT_THAT(check({.cert = "c"}), StatusIs(kInvalid, HasSubstr("--tls-key")));
  EXPECT_THAT(check({.key = "k"}), StatusIs(kInvalid, HasSubstr("--tls-cert")));
  EXPECT_THAT(check({.client_ca = "a"}), StatusIs(kInvalid, HasSubstr("needs --tls-cert")));
  EXPECT_THAT(check({.cert = "c", .key = "k", .require_client_cert = true}),
              StatusIs(kInvalid, HasSubstr("needs --tls-client-ca")));
  EXPECT_THAT(check({.cert = "/none", .key = "/none"}),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("--tls-cert /none")));
}

TEST(Options, RemoteAddressesMayBeUsedWithTls) {
  ServerOptions options;
  options.listen = "0.0.0.0:50051";
  EXPECT_THAT(CheckListenAddress(options),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("--tls-cert")));
  options.tls.cert = "c.pem";
  EXPECT_THAT(CheckListenAddress(options), IsOk());
}

absl::Status CheckListen(const std::string& listen, bool allow_remote = false) {
  ServerOptions options;
  options.listen = listen;
  options.allow_remote_without_tls = allow_remote;
  return CheckListenAddress(options);
}

TEST(Options, TheIndexOfEarlierSettingsIsTaken) {
  for (const char* index : {"exact", "flann"}) {
    EXPECT_FALSE(Parse({"--db", "/d", "--index", index}).exit_status);
    const Variable variable("GRASPDB_INDEX", index);
    EXPECT_FALSE(Parse({"--db", "/d"}).exit_status);
  }
}

TEST(Options, FlagsAreRead) {
  const ParsedOptions parsed =
      Parse({"--db", "/d", "--listen", "127.0.0.1:0", "--queue", "3", "--descriptor", "vfh263",
             "--voxel-size", "0.002", "--log-level", "warn", "--allow-remote-without-tls",
             "--no-reflection"});
  ASSERT_FALSE(parsed.done);
  EXPECT_EQ(parsed.options.database, "/d");
  EXPECT_EQ(parsed.options.listen, "127.0.0.1:0");
  EXPECT_EQ(parsed.options.queue, 3);
  EXPECT_EQ(parsed.options.descriptor, "vfh263");
  EXPECT_EQ(parsed.options.voxel_size_m, 0.002);
  EXPECT_EQ(parsed.options.log_level, "warn");
  EXPECT_TRUE(parsed.options.allow_remote_without_tls);
  EXPECT_TRUE(parsed.options.no_reflection);
}

TEST(Options, IntervalsOfBackupsHaveUnits) {
  const auto every = [](const char* text) {
    return Parse({"--db", "/d", "--backup-dir", "/b", "--backup-every", text});
  };
  EXPECT_EQ(every("24h").options.backup_every_s, 24 * 3600);
  EXPECT_EQ(every("90m").options.backup_every_s, 90 * 60);
  EXPECT_EQ(every("1.5d").options.backup_every_s, 36 * 3600);
  EXPECT_EQ(every("30").options.backup_every_s, 30);
  EXPECT_EQ(every("h").options.backup_every_s, 3600);
  EXPECT_EQ(every("0").options.backup_every_s, 0);
  for (const char* wrong : {"-1h", "3 weeks", "1e9d", ""}) {
    EXPECT_EQ(every(wrong).exit_status, 2) << wrong;
  }
  EXPECT_EQ(Parse({"--db", "/d", "--backup-every", "24h"}).exit_status, 2) << "no folder";
  EXPECT_EQ(Parse({"--db", "/d"}).options.backup_dir, "");
  const Variable folder("GRASPDB_BACKUP_DIR", "/b");
  const Variable interval("GRASPDB_BACKUP_EVERY", "12h");
  EXPECT_EQ(Parse({"--db", "/d"}).options.backup_every_s, 12 * 3600);
  EXPECT_EQ(Parse({"--db", "/d"}).options.backup_dir, "/b");
}

TEST(Options, RemoteListeningIsOffByDefault) {
  EXPECT_FALSE(Parse({"--db", "/d"}).options.allow_remote_without_tls);
  EXPECT_EQ(Parse({"--db", "/d"}).options.listen, "127.0.0.1:50051");
}

TEST(Options, FlagsOverrideVariablesAndTheseTheFile) {
  const files::TemporaryFolder folder;
  const std::string file =
      folder.Write("server.conf", "db=/from-file\nqueue=1\nmax-points=1000\ndrain=3\n").string();
  const Variable queue("GRASPDB_QUEUE", "2");
  const Variable max_points("GRASPDB_MAX_POINTS", "2000");
  const ParsedOptions parsed = Parse({"--config", file, "--queue", "3"});
  ASSERT_FALSE(parsed.done);
  EXPECT_EQ(parsed.options.database, "/from-file");
  EXPECT_EQ(parsed.options.drain_s, 3);
  EXPECT_EQ(parsed.options.max_points, 2000);
  EXPECT_EQ(parsed.options.queue, 3);
}

TEST(Options, FileCanBeSetByAVariable) {
  const files::TemporaryFolder folder;
  const std::string file = folder.Write("server.conf", "db=/from-file\n").string();
  const Variable config("GRASPDB_CONFIG", file.c_str());
  EXPECT_EQ(Parse({}).options.database, "/from-file");
}

TEST(Options, FlagVariableCanBeFalse) {
  const Variable no("GRASPDB_ALLOW_REMOTE_WITHOUT_TLS", "false");
  const ParsedOptions parsed = Parse({"--db", "/d"});
  ASSERT_FALSE(parsed.done);
  EXPECT_FALSE(parsed.options.allow_remote_without_tls);
}

struct WrongUsage {
  std::vector<std::string> arguments;
  std::string words;
};

TEST(Options, WrongUsageIsReportedWithExitStatusTwo) {
  const files::TemporaryFolder folder;
  const std::string typo = folder.Write("typo.conf", "db=/d\nqueeu=3\n").string();
  const std::vector<WrongUsage> cases = {
      {{}, "--db"},
      {{"--db", "/d", "--nonsense"}, "--nonsense"},
      {{"--db", "/d", "--queue", "-1"}, "--queue"},
      {{"--db", "/d", "--queue", "many"}, "many"},
      {{"--db", "/d", "--descriptor", "sift"}, "sift"},
      {{"--db", "/d", "--voxel-size", "3"}, "--voxel-size"},
      {{"--db", "/d", "--log-level", "loud"}, "loud"},
      {{"--db", "/d", "--config", "/nonexistent/file"}, "/nonexistent/file"},
      {{"--db", "/d", "--config", typo}, "queeu"},
      {{"--db", "/d", "extra"}, "extra"},
  };
  for (const WrongUsage& wrong : cases) {
    ::testing::internal::CaptureStderr();
    const ParsedOptions parsed = Parse(wrong.arguments);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr(wrong.words));
    EXPECT_TRUE(parsed.done) << wrong.words;
    EXPECT_EQ(parsed.exit_status, 2) << wrong.words;
  }
}

TEST(Options, HelpAndVersionHaveExitStatusZero) {
  for (const char* flag : {"--help", "--version"}) {
    ::testing::internal::CaptureStdout();
    const ParsedOptions parsed = Parse({flag});
    EXPECT_THAT(::testing::internal::GetCapturedStdout(), HasSubstr("graspdb-server"));
    EXPECT_TRUE(parsed.done);
    EXPECT_EQ(parsed.exit_status, 0);
  }
}

TEST(ListenAddress, ThisMachineIsAllowed) {
  for (const char* listen :
       {"127.0.0.1:0", "127.0.0.1:50051", "127.1.2.3:1", "localhost:50051", "[::1]:65535"}) {
    EXPECT_THAT(CheckListen(listen), IsOk()) << listen;
  }
}

TEST(ListenAddress, OthersNeedTheFlag) {
  for (const char* listen : {"0.0.0.0:50051", "[::]:50051", "192.168.1.4:50051", "example.org:1",
                             "127.example.org:1", "127.0.0.1.example.org:1"}) {
    EXPECT_THAT(CheckListen(listen), StatusIs(absl::StatusCode::kFailedPrecondition,
                                              HasSubstr("--allow-remote-without-tls")))
        << listen;
    EXPECT_THAT(CheckListen(listen, /*allow_remote=*/true), IsOk()) << listen;
  }
}

TEST(ListenAddress, InvalidAddressIsRejectedEvenWithTheFlag) {
  for (const char* listen : {"", "127.0.0.1", ":50051", "127.0.0.1:", "127.0.0.1:x", "127.0.0.1:-1",
                             "127.0.0.1:65536", "unix:/tmp/socket"}) {
    EXPECT_THAT(CheckListen(listen, /*allow_remote=*/true),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("HOST:PORT")))
        << listen;
  }
}

}  // namespace
}  // namespace graspdb::server
