// More messages at once than fit into the memory budget of the server.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "client/sdk/client.h"
#include "files/messages/scan_message.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::end_to_end {
namespace {

using ::graspdb::testing::IsOk;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kClients = 16;
constexpr int kMemoryMib = 256;
constexpr std::size_t kLargePoints = 1'900'000;  // 23 MB, within the limit for points
constexpr absl::Duration kTimeout = absl::Minutes(5);

class FloodTest : public ProgramsTest {
 protected:
  client::Client Connect() const {
    return client::Client(
        {.server = address_, .timeout = kTimeout, .busy_retries = 0, .own_connection = true});
  }
  static v1::RecognizeRequest CloudOf(std::size_t points) {
    v1::RecognizeRequest out;
    *out.mutable_cloud() = files::CloudMessage(recognition::Points(points, {0.1F, 0.1F, 0.6F}), 0);
    out.set_segmented(true);
    return out;
  }
};

TEST_F(FloodTest, StaysWithinTheMemoryBudgetAndAnswersRobots) {
  StartServer("db", {"--memory-mib", std::to_string(kMemoryMib)});
  const v1::RecognizeRequest large = CloudOf(kLargePoints);
  std::atomic<int> running = kClients;
  std::vector<absl::Status> ends(kClients);
  std::vector<std::thread> flood;
  flood.reserve(ends.size());
  for (absl::Status& end : ends) {
    flood.emplace_back([&] {
      end = Connect().Recognize(large).status();
      --running;
    });
  }
  const v1::RecognizeRequest frame = CloudOf(1000);
  client::Client robot = Connect();
  std::int64_t max_bytes = 0;
  while (running > 0) {
    // gRPC may close a connection when memory is short; the server has memory for a small frame.
    const absl::Status answer = robot.Recognize(frame).status();
    EXPECT_THAT(answer.message(), Not(HasSubstr("no memory left")));
    if (const auto status = robot.GetCatalogStatus(); status.ok()) {
      max_bytes = std::max(max_bytes, status->memory().resident_byte_count());
    }
  }
  for (std::thread& client : flood) client.join();
  for (const absl::Status& end : ends) {
    EXPECT_THAT(end.code(), AnyOf(absl::StatusCode::kOk, absl::StatusCode::kResourceExhausted,
                                  absl::StatusCode::kUnavailable))
        << end;
  }
  EXPECT_THAT(robot.Recognize(frame), IsOk());
  EXPECT_LT(max_bytes, std::int64_t{kMemoryMib + 256} << 20);
}

}  // namespace
}  // namespace graspdb::end_to_end
