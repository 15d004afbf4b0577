// What the log has of a cell that cannot be read.
#include "client/cell/agent/jobs/cell_cache.h"

#include <gmock/gmock.h>
#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "absl/time/clock.h"
#include "tests/client/cell/agent/scripted_server.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class CellCacheTest : public ::testing::Test {
 protected:
  CellCacheTest() {
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("captured", log_));
  }
  ~CellCacheTest() override { spdlog::set_default_logger(before_); }

  void Answer(const grpc::Status& status) {
    server_.Change(
        [&](ScriptedServer& server) { server.get_cell = [status](v1::Cell*) { return status; }; });
  }

  const std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
  const std::shared_ptr<spdlog::sinks::ringbuffer_sink_mt> log_ =
      std::make_shared<spdlog::sinks::ringbuffer_sink_mt>(16);
  ScriptedServer server_;
};

TEST_F(CellCacheTest, AMissingCellIsNotLoggedAsALostServer) {
  Answer({grpc::StatusCode::NOT_FOUND, "none"});
  Client client = server_.Connect();
  CellCache cache(client, "cells/press-3", absl::Hours(1));
  EXPECT_THAT(cache.Refresh(), StatusIs(absl::StatusCode::kFailedPrecondition));
  EXPECT_THAT(log_->last_formatted(), ElementsAre(AllOf(HasSubstr("event=cell_unusable"),
                                                        HasSubstr("graspdb cells set press-3"))));
}

TEST_F(CellCacheTest, TheServersVersionIsReadAgainAfterAnOutage) {
  Answer(grpc::Status::OK);
  Client client = server_.Connect();
  CellCache cache(client, "cells/press-3", absl::Milliseconds(1));
  const auto wait_until = [](const auto& holds) {
    while (!holds()) absl::SleepFor(absl::Milliseconds(1));
  };
  wait_until([&] { return cache.server_version() == "9.8"; });
  Answer({grpc::StatusCode::UNAVAILABLE, "gone"});
  wait_until([&] { return !cache.state().ok(); });
  server_.Change([](ScriptedServer& server) { server.version = "9.9"; });
  Answer(grpc::Status::OK);
  wait_until([&] { return cache.server_version() == "9.9"; });
}

TEST_F(CellCacheTest, AServerThatDoesNotAnswerIsLost) {
  Answer(grpc::Status::OK);
  Client client = server_.Connect();
  CellCache cache(client, "cells/press-3", absl::Hours(1));
  EXPECT_THAT(cache.Refresh(), IsOk());
  Answer({grpc::StatusCode::UNAVAILABLE, "gone"});
  EXPECT_THAT(cache.Refresh(), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_THAT(log_->last_formatted(), Contains(HasSubstr("event=server_lost")));
}

TEST_F(CellCacheTest, AServerThatIsAwayFromTheStartIsLoggedOnce) {
  Answer({grpc::StatusCode::UNAVAILABLE, "away"});
  Client client = server_.Connect();
  CellCache cache(client, "cells/press-3", absl::Hours(1));
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(cache.Refresh(), StatusIs(absl::StatusCode::kUnavailable));
  }
  EXPECT_THAT(log_->last_formatted(),
              ElementsAre(AllOf(HasSubstr("event=server_lost"), HasSubstr("away"))));
}

}  // namespace
}  // namespace graspdb::client
