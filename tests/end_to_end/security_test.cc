// Programs over mutual TLS, with identities, roles and the audit log.
#include <gmock/gmock.h>
#include <google/protobuf/util/json_util.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "absl/time/clock.h"
#include "graspdb/v1/audit.pb.h"
#include "tests/end_to_end/fixtures/cell_fixture.h"
#include "tests/end_to_end/fixtures/outcome_matchers.h"
#include "tests/testing/certificates.h"

namespace graspdb::end_to_end {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Words = std::vector<std::string>;

class SecurityTest : public CellProgramsTest {
 protected:
  void SetUp() override {
    folder_.Write("plant.pem", plant_.certificate());
    folder_.Write("other.pem", other_.certificate());
    WritePair("server", plant_.IssueForLoopback());
    WritePair("engineer", plant_.Issue("engineer", "URI:spiffe://plant/engineer"));
    WritePair("expired", plant_.Issue("engineer", "URI:spiffe://plant/engineer", -60));
    WritePair("alien", other_.Issue("engineer", "URI:spiffe://plant/engineer"));
    std::ofstream(Path("identities.jsonl")) << R"({"name":"engineer","roles":["ROLE_ADMIN"],)"
                                            << R"("certificates":["uri:spiffe://plant/engineer"]})"
                                            << "\n";
  }

  void WritePair(const std::string& name, const testing::KeyPair& pair) const {
    folder_.Write(name + ".pem", pair.certificate);
    folder_.Write(name + ".key", pair.key);
  }

  void StartMutualTls() {
    StartServer(
        "db", {"--tls-cert", Path("server.pem"), "--tls-key", Path("server.key"), "--tls-client-ca",
               Path("plant.pem"), "--require-client-cert", "--identities", Path("identities.jsonl"),
               "--audit-log", Path("audit.jsonl"), "--log-level", "debug"});
  }

  // Runs graspdb with a certificate.
  Finished As(const std::string& name, const Words& words, const std::string& ca = "plant") const {
    Words flags = {"--ca",  Path(ca + ".pem"),  "--cert", Path(name + ".pem"),
                   "--key", Path(name + ".key")};
    flags.insert(flags.end(), words.begin(), words.end());
    return Graspdb(flags);
  }

  // Makes an identity with a token in the file of that name.
  void AddToken(const std::string& name, const Words& flags) const {
    Words words = {GRASPDB_SERVER_PROGRAM, "token", name, "--out", Path(name + ".token")};
    words.insert(words.end(), flags.begin(), flags.end());
    const Finished made = RunProgram(folder_.path(), words);
    ASSERT_THAT(made, EndsWith(0));
    std::ofstream(Path("identities.jsonl"), std::ios::app) << made.out;
  }
  std::string TokenOf(const std::string& name) const {
    std::string token;
    std::getline(std::ifstream(Path(name + ".token")), token);
    return token;
  }

  std::vector<v1::AuditRecord> Audited() const {
    std::vector<v1::AuditRecord> out;
    std::ifstream file(Path("audit.jsonl"));
    for (std::string line; std::getline(file, line);) {
      EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(line, &out.emplace_back()).ok());
    }
    return out;
  }

  const testing::Authority plant_{"plant"};
  const testing::Authority other_{"other"};
};

TEST_F(SecurityTest, MutualTls) {
  StartMutualTls();
  EXPECT_THAT(As("engineer", {"status"}), EndsWith(0));
  EXPECT_THAT(RunProgram(folder_.path(),
                         {GRASPDB_SERVER_PROGRAM, "health", address_, "--ca", Path("plant.pem"),
                          "--cert", Path("server.pem"), "--key", Path("server.key")}),
              EndsWith(0));
  const auto health = [&](const Words& words) {
    Words command = {GRASPDB_SERVER_PROGRAM, "health", address_};
    command.insert(command.end(), words.begin(), words.end());
    return RunProgram(folder_.path(), command);
  };
  EXPECT_THAT(health({}).err, HasSubstr("give --ca if it uses TLS"));
  EXPECT_THAT(health({"--ca", Path("none")}).err, HasSubstr("none cannot be read (No such file"));
  const Finished of_folder = health({"--ca", folder_.path().string()});
  EXPECT_THAT(of_folder, EndsWith(1));
  EXPECT_THAT(of_folder.err, HasSubstr("is not a regular file"));
  const Finished expired = As("expired", {"status"});
  EXPECT_THAT(expired, EndsWith(1));
  EXPECT_THAT(expired, PrintsOnly("graspdb", "expired.pem expired on"));
  const Finished alien = As("alien", {"status"});
  EXPECT_THAT(alien, EndsWith(3));
  EXPECT_THAT(alien, PrintsOnly("graspdb", "does not accept --cert"));
  EXPECT_THAT(As("engineer", {"status"}, "other"), PrintsOnly("graspdb", "authority of --ca"));
  EXPECT_THAT(Graspdb({"--ca", Path("plant.pem"), "status"}),
              PrintsOnly("graspdb", "give --cert and --key"));
  EXPECT_THAT(Graspdb({"status"}), PrintsOnly("graspdb", "give --ca if it uses TLS"));
  EXPECT_THAT(Graspdb({"--ca", Path("none.pem"), "status"}),
              PrintsOnly("graspdb", "none.pem cannot be read"));

  // Both refused handshakes, of clients that may have tried again.
  std::string errors;
  for (const v1::AuditRecord& record : Audited()) {
    EXPECT_EQ(record.method(), "TLS handshake");
    EXPECT_EQ(record.code(), "UNAUTHENTICATED");
    errors += record.error() + "\n";
  }
  EXPECT_THAT(errors, HasSubstr("the client certificate /CN=engineer, serial number "));
  EXPECT_THAT(errors, HasSubstr("was refused: unable to get local issuer certificate"));
  EXPECT_THAT(errors, HasSubstr("the client has no certificate"));
}

TEST_F(SecurityTest, VariablesTakeThePlaceOfFlags) {
  StartMutualTls();
  const Words command = {"/usr/bin/env",
                         "GRASPDB_SERVER=" + address_,
                         "GRASPDB_CA=" + Path("plant.pem"),
                         "GRASPDB_CERT=" + Path("engineer.pem"),
                         "GRASPDB_KEY=" + Path("engineer.key"),
                         GRASPDB_PROGRAM,
                         "status"};
  EXPECT_THAT(RunProgram(folder_.path(), command), EndsWith(0));
}

TEST_F(SecurityTest, TokensRolesAndTheAuditLog) {
  AddToken("reader", {"--role", "read"});
  struct stat file {};
  ASSERT_EQ(stat(Path("reader.token").c_str(), &file), 0);
  EXPECT_EQ(file.st_mode & 0777U, 0600U);
  StartMutualTls();
  const Words token = {"--token-file", Path("reader.token")};
  const auto as_reader = [&](Words words) {
    words.insert(words.begin(), token.begin(), token.end());
    return As("engineer", words);
  };
  EXPECT_THAT(as_reader({"status"}), EndsWith(0));
  const Finished refused = as_reader({"objects", "delete", "mug"});
  EXPECT_THAT(refused, EndsWith(1));
  EXPECT_THAT(refused, PrintsOnly("graspdb", "identity reader lacks the role teach"));
  EXPECT_THAT(As("engineer", {"objects", "delete", "mug"}), EndsWith(1));  // there is none

  ASSERT_EQ(Audited().size(), 2U);
  EXPECT_EQ(Audited()[0].identity(), "reader");
  EXPECT_EQ(Audited()[0].code(), "PERMISSION_DENIED");
  EXPECT_EQ(Audited()[0].resources(0), "objects/mug");
  EXPECT_THAT(Audited()[0].peer(), HasSubstr("127.0.0.1"));
  EXPECT_EQ(Audited()[1].identity(), "engineer");
  EXPECT_EQ(Audited()[1].code(), "NOT_FOUND");

  // Revoked: the file without the line of the reader.
  std::string first;
  std::getline(std::ifstream(Path("identities.jsonl")), first);
  folder_.Write("identities.jsonl", first + "\n");
  while (as_reader({"status"}).exit_status == 0) absl::SleepFor(absl::Milliseconds(50));
  EXPECT_THAT(as_reader({"status"}), PrintsOnly("graspdb", "the token is unknown"));
  server_->Signal(SIGTERM);
  const Finished server = server_->Wait();
  EXPECT_THAT(server.err + server.out + files::BytesOf(Path("audit.jsonl")),
              AllOf(HasSubstr("event=identities_read"), Not(HasSubstr(TokenOf("reader")))));
}

TEST_F(SecurityTest, DoctorPrintsWhatItFoundBeforeARefusedCall) {
  AddToken("agent", {"--role", "read", "--cell", "press-3"});
  StartMutualTls();
  const Finished refused = As("engineer", {"--token-file", Path("agent.token"), "doctor"});
  EXPECT_THAT(refused, EndsWith(1));
  EXPECT_THAT(refused.out, HasSubstr("warning  server: the catalogue is empty"));
  EXPECT_THAT(refused.err, HasSubstr("identity agent may use cells/press-3 only"));
}

TEST_F(SecurityTest, TheServerKeepsItsCertificateWhileTheFilesAreEmptied) {
  StartMutualTls();
  ASSERT_THAT(As("engineer", {"status"}), EndsWith(0));
  const auto empty = [&](const std::string& file, const std::string& reason) {
    std::filesystem::resize_file(Path(file), 0);
    EXPECT_TRUE(server_->WaitForError(reason));
    EXPECT_THAT(As("engineer", {"status"}), EndsWith(0));
  };
  empty("server.pem", "server.pem has no certificate");
  const testing::KeyPair next = other_.IssueForLoopback();
  folder_.Write("server.pem", next.certificate);
  // A second after the first, in which gRPC reads what it was given.
  empty("server.key", "server.key has no private key");
  folder_.Write("server.key", next.key);
  while (As("engineer", {"status"}, "other").exit_status != 0) {
    absl::SleepFor(absl::Milliseconds(50));
  }
  EXPECT_THAT(As("engineer", {"status"}), PrintsOnly("graspdb", "authority of --ca"));
}

TEST_F(SecurityTest, TokenPrintsItOnce) {
  const Finished made =
      RunProgram(folder_.path(), {GRASPDB_SERVER_PROGRAM, "token", "press-3", "--role", "read",
                                  "--role", "recognise", "--cell", "press-3"});
  EXPECT_THAT(made, EndsWith(0));
  EXPECT_THAT(made.out,
              ::testing::MatchesRegex(
                  "graspdb_[A-Za-z0-9_-]+\n"
                  "\\{\"name\":\"press-3\",\"roles\":\\[\"ROLE_READ\",\"ROLE_RECOGNISE\"\\],"
                  "\"cell\":\"cells/press-3\",\"tokenSha256\":\\[\"[A-Za-z0-9+/]{43}=\"\\]\\}\n"));
  const auto run = [&](const Words& words) {
    Words command = {GRASPDB_SERVER_PROGRAM, "token"};
    command.insert(command.end(), words.begin(), words.end());
    return RunProgram(folder_.path(), command);
  };
  EXPECT_THAT(run({}), EndsWith(2));
  for (const char* role : {"king", "1", "ROLE_READ"}) {
    const Finished refused = run({"a", "--role", role});
    EXPECT_THAT(refused, EndsWith(2));
    EXPECT_THAT(refused.err, HasSubstr("{read,recognise,teach,operate,admin}"));
  }
  EXPECT_THAT(run({"a b", "--role", "read"}), EndsWith(2));
  folder_.Write("old.token", "old");
  const Finished kept = run({"a", "--role", "read", "--out", Path("old.token")});
  EXPECT_THAT(kept, EndsWith(1));
  EXPECT_THAT(kept, PrintsOnly("graspdb-server", "old.token"));
  EXPECT_EQ(files::BytesOf(Path("old.token")), "old");
}

TEST_F(SecurityTest, FilesThatCannotBeUsedEndTheStart) {
  const auto serve = [&](const Words& flags) {
    Words command = ServerCommand(Path("db"), "127.0.0.1:0");
    command.insert(command.end(), flags.begin(), flags.end());
    return RunProgram(folder_.path(), command);
  };
  const Finished expired =
      serve({"--tls-cert", Path("expired.pem"), "--tls-key", Path("expired.key")});
  EXPECT_THAT(expired, EndsWith(1));
  EXPECT_THAT(expired, PrintsOnly("graspdb-server", "expired on"));
  folder_.Write("bad.jsonl", "{}\n");
  const Finished bad = serve({"--identities", Path("bad.jsonl")});
  EXPECT_THAT(bad, EndsWith(1));
  EXPECT_THAT(bad, PrintsOnly("graspdb-server", "bad.jsonl: line 1"));
  EXPECT_THAT(serve({"--tls-cert", Path("server.pem")}), EndsWith(2));
}

TEST_F(SecurityTest, AnAgentIsBoundToItsCell) {
  AddToken("agent", {"--role", "read", "--role", "recognise", "--cell", "press-3"});
  AddToken("stranger", {"--role", "read", "--role", "recognise", "--cell", "press-4"});
  // The commands of StartCell, by the variables.
  setenv("GRASPDB_IDENTITIES", Path("identities.jsonl").c_str(), 1);
  setenv("GRASPDB_TLS_CERT", Path("server.pem").c_str(), 1);
  setenv("GRASPDB_TLS_KEY", Path("server.key").c_str(), 1);
  setenv("GRASPDB_TLS_CLIENT_CA", Path("plant.pem").c_str(), 1);
  setenv("GRASPDB_CA", Path("plant.pem").c_str(), 1);
  setenv("GRASPDB_CERT", Path("engineer.pem").c_str(), 1);
  setenv("GRASPDB_KEY", Path("engineer.key").c_str(), 1);
  StartCell();
  const rendering::PlannedCapture scene = LayOut(0);
  const auto start = [&](const std::string& name) {
    StartAgentWith("simulated:scene=" + Path(scene_), {"--token-file", Path(name + ".token")},
                   {"--unset=GRASPDB_CERT", "--unset=GRASPDB_KEY"});
  };
  start("agent");
  client::GriClient robot = Robot();
  ExpectHolds(Trigger(robot), scene);
  start("stranger");
  client::GriClient other = Robot();
  EXPECT_NE(Trigger(other).code, client::GriCode::kNoError);
  EXPECT_TRUE(agent_->WaitForError("may use cells/press-4 only, not cells/press-3"));
  for (const char* name :
       {"IDENTITIES", "TLS_CERT", "TLS_KEY", "TLS_CLIENT_CA", "CA", "CERT", "KEY"}) {
    unsetenv((std::string("GRASPDB_") + name).c_str());
  }
}

}  // namespace
}  // namespace graspdb::end_to_end
