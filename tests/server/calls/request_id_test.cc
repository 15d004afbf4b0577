// Ids of calls, in the trailing metadata and in the log.
#include "program/log/request_id.h"

#include <gmock/gmock.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <sstream>

#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

class RequestIdTest : public ServerTest {
 protected:
  // The id in the trailing metadata of a call with this one; none is sent if empty.
  std::string IdOfCallWith(const std::string& sent) {
    grpc::ClientContext context;
    if (!sent.empty()) context.AddMetadata(kRequestIdKey, sent);
    v1::GetCellRequest request;
    request.set_name("cells/none");
    v1::Cell cell;
    EXPECT_FALSE(StubOf<Cells>().GetCell(&context, request, &cell).ok());
    const auto& trailing = context.GetServerTrailingMetadata();
    EXPECT_EQ(trailing.count(kRequestIdKey), 1U);
    const auto id = trailing.find(kRequestIdKey);
    return id == trailing.end() ? "" : std::string(id->second.data(), id->second.size());
  }
};

TEST_F(RequestIdTest, TheIdOfTheCallerIsReturned) {
  EXPECT_EQ(IdOfCallWith("job-17.3"), "job-17.3");
}

TEST_F(RequestIdTest, OtherwiseTheServerMakesOne) {
  for (const std::string& sent : {std::string(), std::string("a b"), std::string(1000, 'x')}) {
    const std::string id = IdOfCallWith(sent);
    EXPECT_TRUE(IsRequestId(id)) << id;
    EXPECT_NE(id, sent);
  }
}

TEST_F(RequestIdTest, TheLogLineOfTheCallHasIt) {
  std::ostringstream log;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(
      "test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log)));
  spdlog::set_level(spdlog::level::info);
  IdOfCallWith("job-17.3");
  Answer(RequestOf(PhotographEmptyTable()));
  server_.reset();
  spdlog::set_default_logger(before);
  spdlog::set_level(spdlog::level::off);
  EXPECT_THAT(log.str(), ::testing::ContainsRegex("method=GetCell .*request_id=job-17.3 error="));
  EXPECT_THAT(log.str(), ::testing::ContainsRegex(
                             "method=Recognize .*request_id=[0-9a-f]+ status=NO_CLUSTER"));
}

}  // namespace
}  // namespace graspdb::testing
