#include "client/cell/agent/settings/agent_options.h"

#include <gmock/gmock.h>

#include <fstream>

#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

ParsedAgentOptions Parse(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "graspdb-cell");
  std::vector<char*> argv;
  argv.reserve(arguments.size());
  for (std::string& argument : arguments) argv.push_back(argument.data());
  return ParseAgentOptions(static_cast<int>(argv.size()), argv.data());
}

TEST(AgentOptions, RequiresOnlyCellAndSensor) {
  const ParsedAgentOptions parsed = Parse({"--cell", "press-3", "--sensor", "simulated"});
  ASSERT_FALSE(parsed.done);
  EXPECT_EQ(parsed.options.cell, "press-3");
  EXPECT_EQ(parsed.options.gri, "127.0.0.1:7100");
  EXPECT_THAT(parsed.options.jobs, ElementsAre("1 any"));
  EXPECT_THAT(CheckAddresses(parsed.options), IsOk());
  EXPECT_EQ(Parse({"--cell", "press-3"}).exit_status, 2);
}

TEST(AgentOptions, JobsAreRepeatedFlagsOrAListInAFile) {
  EXPECT_THAT(Parse({"--cell", "c", "--sensor", "s", "--job", "1 any", "--job", "2 object=nut"})
                  .options.jobs,
              ElementsAre("1 any", "2 object=nut"));
  const files::TemporaryFolder folder;
  const std::string path = (folder.path() / "cell.toml").string();
  std::ofstream(path) << "cell=\"press-3\"\nsensor=\"freenect\"\njob=[\"1 any\",\"2 label=small "
                         "primary=object\"]\nallow-remote-robots=true\ngri=\"0.0.0.0:7100\"\n";
  const ParsedAgentOptions parsed = Parse({"--config", path});
  ASSERT_FALSE(parsed.done);
  EXPECT_THAT(parsed.options.jobs, ElementsAre("1 any", "2 label=small primary=object"));
  EXPECT_THAT(CheckAddresses(parsed.options), IsOk());
}

TEST(AgentOptions, RemoteRobotsMustBeAllowed) {
  AgentOptions options;
  options.gri = "0.0.0.0:7100";
  EXPECT_THAT(CheckAddresses(options),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("--allow-remote-robots")));
  options.allow_remote_robots = true;
  EXPECT_THAT(CheckAddresses(options), IsOk());
  options.line = "7101";
  EXPECT_THAT(CheckAddresses(options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("--line 7101")));
  options.gri = options.line = "";
  EXPECT_THAT(CheckAddresses(options), StatusIs(absl::StatusCode::kInvalidArgument));
}

TEST(AgentOptions, SomeDistanceMustBeWithinReach) {
  AgentOptions options;
  EXPECT_THAT(CheckReach(options), IsOk());
  options.min_reach_m = 0.3;
  options.max_reach_m = 1.3;
  EXPECT_THAT(CheckReach(options), IsOk());
  options.min_reach_m = 1.3;
  EXPECT_THAT(CheckReach(options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("--min-reach 1.3")));
}

TEST(AgentOptions, SecurityFlagsAreRead) {
  const AgentOptions options =
      Parse({"--cell", "c", "--sensor", "s", "--ca", "ca.pem", "--cert", "c.pem", "--key", "k.pem",
             "--token-file", "t", "--robots-allow", "10.3.0.0/24,10.4.0.7"})
          .options;
  EXPECT_EQ(options.security.ca, "ca.pem");
  EXPECT_EQ(options.security.cert, "c.pem");
  EXPECT_EQ(options.security.key, "k.pem");
  EXPECT_EQ(options.security.token_file, "t");
  EXPECT_THAT(options.robots_allow, ElementsAre("10.3.0.0/24", "10.4.0.7"));
}

TEST(AgentOptions, BusyRetriesAreThoseOfTheClientLibraryUnlessGiven) {
  const auto parse = [](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"--cell", "c", "--sensor", "s"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Parse(arguments);
  };
  EXPECT_EQ(parse({}).options.busy_retries, ConnectionOptions().busy_retries);
  EXPECT_EQ(parse({"--busy-retries", "0"}).options.busy_retries, 0);
  EXPECT_EQ(parse({"--busy-retries", "1000"}).options.busy_retries, 1000);
  for (const char* wrong : {"-1", "1001", "0.5", "often"}) {
    EXPECT_EQ(parse({"--busy-retries", wrong}).exit_status, 2) << wrong;
  }
}

TEST(AgentOptions, LineFormatSetsTheDefaultPoseFormat) {
  AgentOptions options;
  EXPECT_FALSE(LineOptions(options)->pose_format);
  options.line_format = "kuka";
  EXPECT_EQ(LineOptions(options)->pose_format, 24);
  options.line_format = "52";
  EXPECT_THAT(LineOptions(options),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("--line-format")));
}

}  // namespace
}  // namespace graspdb::client
