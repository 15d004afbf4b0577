// The line protocol over TCP.
#include <gmock/gmock.h>

#include <memory>
#include <random>

#include "tests/client/cell/robots/line_protocol_fixture.h"
#include "tests/client/cell/robots/socket_robot.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::StartsWith;

class LineServerTest : public LineProtocolTest {
 protected:
  void SetUp() override {
    auto started = RobotServer::Start(protocol_, {});
    ASSERT_THAT(started, IsOk());
    server_ = *std::move(started);
  }

  static std::string Line(SocketRobot& robot) {
    std::string out;
    while (!out.ends_with('\n')) {
      const std::string next = robot.Receive(1);
      if (next.empty()) break;
      out += next;
    }
    return out;
  }

  std::unique_ptr<RobotServer> server_;
};

TEST_F(LineServerTest, AnswersLinesInOrderHoweverTheyAreSplit) {
  SocketRobot robot(server_->port());
  for (const char byte : std::string("STA")) robot.Send({byte});
  robot.Send("TUS\r\nFORMAT UR\nNEXT 8\n\nQUIT\n");
  EXPECT_EQ(Line(robot), "OK 1\n");
  EXPECT_EQ(Line(robot), "OK 3\n");
  EXPECT_THAT(Line(robot), StartsWith("ERR 1 "));
  EXPECT_THAT(Line(robot), StartsWith("ERR -6 "));
  EXPECT_EQ(Line(robot), "OK\n");
  EXPECT_TRUE(robot.IsHungUpOn());
}

TEST_F(LineServerTest, ARobotMayReconnectForEveryLine) {
  const auto call = [this](const std::string& line) {
    SocketRobot robot(server_->port());
    robot.Send(line + "\n");
    return Line(robot);
  };
  EXPECT_EQ(call("FORMAT STAUBLI"), "OK 4\n");
  EXPECT_THAT(call("RUN 7"), StartsWith("OK 1 1 500.000 "));
  EXPECT_THAT(call("RELATED 7"), StartsWith("OK 1 0 600.000 "));
  EXPECT_EQ(call("MISSED"), "OK\n");
  EXPECT_THAT(call("NEXT 7"), StartsWith("OK 0 0 550.000 "));
}

TEST_F(LineServerTest, ALineThatIsTooLongClosesTheConnection) {
  SocketRobot robot(server_->port());
  robot.Send(std::string(kMaxRequestBytes - 1, 'x') + "\n");
  EXPECT_THAT(Line(robot), StartsWith("ERR -8 "));
  robot.Send(std::string(kMaxRequestBytes, 'x') + "\n");
  EXPECT_THAT(Line(robot), StartsWith("ERR -7 INVALID_REQUEST_LENGTH: "));
  EXPECT_TRUE(robot.IsHungUpOn());
}

TEST_F(LineServerTest, ToleratesGarbage) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 50; ++i) {
    SocketRobot robot(server_->port());
    std::string garbage(1 + random() % 5'000, '\0');
    for (char& byte : garbage) byte = static_cast<char>(random());
    robot.Send(garbage + "\n");
    EXPECT_THAT(Line(robot), AllOf(StartsWith("ERR -"), EndsWith("\n")));
  }
  SocketRobot robot(server_->port());
  robot.Send("STATUS\n");
  EXPECT_EQ(Line(robot), "OK 1\n");
}

}  // namespace
}  // namespace graspdb::client
