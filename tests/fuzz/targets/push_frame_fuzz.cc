// Frames that programs push to the agent of a cell.
#include <cmath>
#include <cstdint>
#include <variant>

#include "client/cell/sensors/push/push_sensor.h"
#include "files/messages/scan_message.h"
#include "tests/fuzz/message_target.h"
#include "tests/fuzz/requirement.h"

namespace graspdb::fuzz {
namespace {

// When frames arrive: a second after the capture times of the seeds.
constexpr std::int64_t kArrival = 1'700'000'001;

const std::vector<std::string>& Words() {
  static const std::vector<std::string> words = {"x", "y", "z", "rgb", "left", "right", ""};
  return words;
}

std::size_t PointCount(const v1::PushFrameRequest& request) {
  if (request.has_depth_image()) return request.depth_image().data().size() / 2;
  return request.cloud().data().size() / static_cast<std::size_t>(request.cloud().point_stride());
}

void Run(const v1::PushFrameRequest& request) {
  const absl::Time arrival = absl::FromUnixSeconds(kArrival);
  const MonotonicTime now = MonotonicTime::Now();
  const auto frame = client::PushedFrame(request, arrival, now);
  if (!frame.ok()) {
    Require(absl::IsInvalidArgument(frame.status()), "a frame or a refusal");
    return;
  }
  Require(frame->time <= now && now - frame->time <= client::kMaxPushedAge, "an age in its limits");
  const auto points =
      std::visit([](const auto& scan) { return files::PointsFromMessage(scan); }, frame->scan);
  Require(points.ok(), "a frame that the agent reads");
  Require(points->size() == PointCount(request), "as many points as were sent");
}

}  // namespace
}  // namespace graspdb::fuzz

GRASPDB_FUZZ_MESSAGES(graspdb::v1::PushFrameRequest, graspdb::fuzz::Words(), graspdb::fuzz::Run)
