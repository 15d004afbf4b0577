// Exit statuses, help and settings of graspdb.
#include <gmock/gmock.h>

#include <cstdlib>
#include <sstream>

#include "tests/end_to_end/fixtures/outcome_matchers.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"
#include "tests/end_to_end/fixtures/written_clouds.h"

namespace graspdb::end_to_end {
namespace {

using ::testing::HasSubstr;
using Words = std::vector<std::string>;

// No server listens here.
constexpr char kNoServer[] = "127.0.0.1:1";

class UsageTest : public ProgramsTest {};

TEST_F(UsageTest, ExitsWithTwoForWrongUsage) {
  const std::string cloud = folder_.Write("a.pcd", AsciiPcd(CurvedPatch(100))).string();
  const std::vector<std::pair<Words, std::string>> cases = {
      {{}, "subcommand"},
      {{"paint"}, "there is no command paint; see graspdb --help"},
      {{"impot", "a.graspdb"}, "there is no command impot; the nearest one is import"},
      {{"objects", "lst"}, "there is no command lst; the nearest one is list"},
      {{"status", "--colour"}, "--colour"},
      {{"recognize"}, "INPUT"},
      {{"describe", cloud, "--descriptor", "sift"}, "sift"},
      {{"describe", cloud, "--viewpoint", "1,2"}, "--viewpoint"},
      {{"import", ".", "--split", "HALF"}, "HALF"},
      {{"--timeout", "0", "status"}, "--timeout"},
      {{"--busy-retries", "-1", "status"}, "--busy-retries"},
      {{"--busy-retries", "1001", "status"}, "--busy-retries"},
      {{"cells", "set", "c", "--sensor-pose", "1,2,3"}, "--sensor-pose"},
      {{"objects", "show"}, "OBJECT"},
      {{"cells", "check", "press"}, "nothing to check; give --frame or --sensor"},
      {{"grasps", "import", "mug", "grasps.json"}, "name it with --stable-pose"},
      {{"sensors", "grab", "kinekt", "--out", "x"}, "there is no kind of sensor \"kinekt\""},
      {{"sensors", "grab", "simulated:sed=1", "--out", "x"}, "sed"},
      {{"objects", "restore", "mug", "--revision", "0"}, "--revision: give a whole number of 1 or"},
      {{"backup", "verify", "0"}, "give a whole number of 1 or more, not 0"},
      {{"backup", "diff", "abc"}, "give a whole number of 1 or more, not abc"},
      {{"backup", "delete", "7", "0"}, "give a whole number of 1 or more, not 0"},
      {{"backup", "restore", "--from", "a", "--to", "b", "--id", "0"}, "--id: give a whole number"},
      {{"backup", "verify", "backups/0"}, "give a whole number of 1 or more, not 0"},
      {{"export", ""}, "SET: give a file or a folder"},
      {{"--timeout", "nan", "status"}, "--timeout: give a number, not nan"},
      {{"--timeout", "--json", "status"}, "--timeout: give a value, not the flag --json"},
      {{"watch", "--catalog-id=", "--json"}, "--catalog-id= has no value"},
      {{"simulate", "--step", "nan", "--out", "x"}, "--step: give a number, not nan"},
      {{"watch", "--after", "-1"}, "give a whole number of 0 or more, not -1"},
      {{"objects"}, "subcommand"},
      {{"simulate", "--parts", "spoon", "--out", "x"}, "spoon"},
      {{"robot", "--scene", "x", "--job", "65536"}, "--job"},
      {{"robot", "--scene", "x", "--picked-job", "-1"}, "--picked-job"},
      {{"robot", "--scene", "x", "--least", "101"}, "--min-percent"},  // its name of before
      {{"bench"}, "--simulate"},
      {{"bench", cloud, "--simulate"}, "either"},
      {{"bench", cloud, "--camera", "v1"}, "--simulate"},
      {{"bench", "--simulate", "--parts", "spoon"}, "spoon"},
      {{"bench", cloud, "--rate", "0"}, "--rate"},
      {{"bench", cloud, "--concurrency", "0"}, "--concurrency"},
      {{"bench", cloud, "--requests", "-1"}, "--requests"},
      {{"bench", cloud, "--duration", "long"}, "--duration"},
      {{"--config", "/nonexistent/file", "status"}, "/nonexistent/file"},
      {{"status"}, "--server \"\" is not HOST:PORT"},  // the address of no server
      {{"--cert", "a.pem", "status"}, "--cert and --key belong together"},
      {{"--key", "a.key", "bench", cloud}, "--cert and --key belong together"},
  };
  for (const auto& [arguments, words] : cases) {
    const Finished outcome = Graspdb(arguments);
    EXPECT_THAT(outcome, EndsWith(2)) << words;
    EXPECT_THAT(outcome.err, HasSubstr(words));
    EXPECT_EQ(outcome.out, "");
  }
}

TEST_F(UsageTest, SimulateExplainsPartsThatAreSeparatedBySpaces) {
  const Finished outcome =
      Graspdb({"simulate", "--parts", "wedge", "l-bracket", "--out", Path("set")});
  EXPECT_THAT(outcome, EndsWith(1));
  EXPECT_THAT(outcome, PrintsOnly("graspdb", "separate ids by commas: --parts wedge,l-bracket"));
}

TEST_F(UsageTest, PrintsItsVersion) {
  const Finished outcome = Graspdb({"--version"});
  EXPECT_THAT(outcome, EndsWith(0));
  EXPECT_THAT(outcome.out, ::testing::MatchesRegex("graspdb [0-9.]+\n"));
}

TEST_F(UsageTest, ExitsWithThreeWithoutAServer) {
  address_ = kNoServer;
  const std::string cloud = folder_.Write("cloud.pcd", AsciiPcd(CurvedPatch(100))).string();
  folder_.Write("captures.json",
                CaptureSetJson(R"("split": "TEACH", "objectId": "o", "stablePoseId": "p")"));
  for (const Words& arguments :
       {Words{"status"}, Words{"objects", "list"}, Words{"recognize", cloud}, Words{"bench", cloud},
        Words{"import", folder_.path().string()}, Words{"cells", "list"},
        Words{"export", (folder_.path() / "out").string()}}) {
    const Finished outcome = Graspdb(arguments);
    EXPECT_THAT(outcome, EndsWith(3)) << arguments[0];
    EXPECT_THAT(outcome, PrintsOnly("graspdb", "start graspdb-server or give --server"));
  }
}

TEST_F(UsageTest, DescribesEveryFlagOfEveryCommand) {
  for (const Words& command :
       {Words{}, Words{"import"}, Words{"recognize"}, Words{"bench"}, Words{"describe"},
        Words{"export"}, Words{"objects"}, Words{"objects", "list"}, Words{"objects", "show"},
        Words{"objects", "delete"}, Words{"cells"}, Words{"cells", "list"}, Words{"cells", "show"},
        Words{"cells", "set"}, Words{"cells", "delete"}, Words{"status"}, Words{"simulate"}}) {
    Words arguments = command;
    arguments.emplace_back("--help");
    std::istringstream help(Succeed(arguments).out);
    // CLI11 puts the text into column 30, or on the next line where that is taken.
    int flags = 0;
    std::string before;
    for (std::string line; std::getline(help, line); before = line) {
      const auto explains = [](const std::string& text) {
        return text.size() > 30 && text[29] == ' ' && text[30] != ' ';
      };
      if (!before.starts_with("  -")) continue;
      ++flags;
      EXPECT_TRUE(explains(before) || explains(line)) << before;
    }
    EXPECT_GE(flags, 1) << (command.empty() ? "graspdb" : command.back());
  }
}

TEST_F(UsageTest, ReadsSettingsFromFlagsThenVariablesThenTheFile) {
  StartServer();
  const std::string file = folder_.Write("good.conf", "server=\"" + address_ + "\"\n").string();
  const std::string bad = folder_.Write("bad.conf", std::string("server=\"") + kNoServer + "\"\n");
  const auto run = [&](const Words& environment, const Words& arguments) {
    Words command = {"/usr/bin/env"};
    command.insert(command.end(), environment.begin(), environment.end());
    command.emplace_back(GRASPDB_PROGRAM);
    command.insert(command.end(), arguments.begin(), arguments.end());
    return RunProgram(folder_.path(), command);
  };
  const std::string good_variable = "GRASPDB_SERVER=" + address_;
  const std::string bad_variable = std::string("GRASPDB_SERVER=") + kNoServer;
  EXPECT_THAT(run({}, {"--config", file, "status"}), EndsWith(0));
  EXPECT_THAT(run({"GRASPDB_CONFIG=" + file}, {"status"}), EndsWith(0));
  EXPECT_THAT(run({good_variable}, {"--config", bad, "status"}), EndsWith(0));
  EXPECT_THAT(run({bad_variable}, {"--config", file, "status"}), EndsWith(3));
  EXPECT_THAT(run({bad_variable}, {"--config", bad, "--server", address_, "status"}), EndsWith(0));
  EXPECT_THAT(run({"GRASPDB_CONFIG=/nonexistent/file"}, {"status"}), EndsWith(2));
  EXPECT_THAT(run({good_variable, "GRASPDB_BUSY_RETRIES=0"}, {"status"}), EndsWith(0));
  EXPECT_THAT(run({good_variable, "GRASPDB_BUSY_RETRIES=often"}, {"status"}), EndsWith(2));
  EXPECT_THAT(run({good_variable, "GRASPDB_JSON=1"}, {"status"}).out,
              ::testing::StartsWith("{\"serverVersion\""));
}

TEST_F(UsageTest, SimulateReadsTheSettingsFileWhereverItIsGiven) {
  const std::string file = folder_.Write("all.conf", "[doctor]\nthresholds=true\n").string();
  Words simulate = {"simulate", "--parts", "wedge", "--step", "180", "--out", Path("first")};
  Words before = {"--config", file};
  before.insert(before.end(), simulate.begin(), simulate.end());
  EXPECT_THAT(Graspdb(before), EndsWith(0));
  simulate.back() = Path("second");
  simulate.insert(simulate.end(), {"--config", file});
  EXPECT_THAT(Graspdb(simulate), EndsWith(0));
}

TEST_F(UsageTest, ExitsWithOneWhereItsOutputCannotBeWritten) {
  const auto run = [&](const std::string& program, const std::string& redirection) {
    return RunProgram(folder_.path(), {"/bin/sh", "-c", "'" + program + "' " + redirection});
  };
  const std::string version = std::string(GRASPDB_PROGRAM) + "' '--version";
  const std::string token = std::string(GRASPDB_SERVER_PROGRAM) + "' 'token' 'a' '--role' 'read";
  for (const std::string& program : {version, token}) {
    for (const char* redirection : {">/dev/full", ">&-"}) {
      const Finished failed = run(program, redirection);
      EXPECT_THAT(failed, EndsWith(1)) << program << redirection;
      EXPECT_THAT(failed.err, HasSubstr("cannot write the output"));
    }
    EXPECT_THAT(run(program, ">/dev/null"), EndsWith(0));
  }
}

TEST_F(UsageTest, WatchEndsWhereItsOutputCannotBeWritten) {
  StartServer();
  const std::string watch = "'" + std::string(GRASPDB_PROGRAM) + "' --server " + address_ +
                            " watch --json --heartbeat 1 >/dev/full";
  const Finished failed = RunProgram(folder_.path(), {"/bin/sh", "-c", watch});
  EXPECT_THAT(failed, EndsWith(1));
  EXPECT_THAT(failed.err, HasSubstr("cannot write the output"));
}

TEST_F(UsageTest, GrabbingEndsWhereItsOutputCannotBeWritten) {
  const std::string grab = "'" + std::string(GRASPDB_PROGRAM) +
                           "' sensors grab simulated --frames 1000000 --out '" + Path("look") +
                           "' >/dev/full";
  const Finished failed = RunProgram(folder_.path(), {"/bin/sh", "-c", grab});
  EXPECT_THAT(failed, EndsWith(1));
  EXPECT_THAT(failed.err, HasSubstr("cannot write the output"));
}

TEST_F(UsageTest, PrintsARejectedScanAsALineOfJson) {
  StartServer("db", {"--max-points", "1000"});
  const std::string good = folder_.Write("good.pcd", AsciiPcd(CurvedPatch(900))).string();
  const std::string bad = folder_.Write("bad.pcd", AsciiPcd(CurvedPatch(1100))).string();
  const Finished two = Graspdb({"recognize", bad, good, "--segmented", "--json"});
  EXPECT_THAT(two, EndsWith(1));
  EXPECT_THAT(two.out, HasSubstr("{\"path\":\"" + bad + "\",\"error\":{"));
  EXPECT_THAT(two.out, HasSubstr("{\"path\":\"" + good + "\",\"response\":{"));
  EXPECT_THAT(two.err, HasSubstr("1 of 2 scans were refused"));
  const Finished one = Graspdb({"recognize", bad, "--segmented", "--json"});
  EXPECT_THAT(one, EndsWith(1));
  EXPECT_THAT(one.out, HasSubstr("{\"path\":\"" + bad + "\",\"error\":{"));
  EXPECT_THAT(one.out, HasSubstr("\"code\":\"INVALID_ARGUMENT\""));
  EXPECT_THAT(one, PrintsOnly("graspdb", "--max-points"));
}

}  // namespace
}  // namespace graspdb::end_to_end
