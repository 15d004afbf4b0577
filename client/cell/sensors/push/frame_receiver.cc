#include "client/cell/sensors/push/frame_receiver.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/sensors/push/pushed_frame.h"
#include "program/log/log_field.h"

namespace graspdb::client {

FrameReceiver::FrameReceiver(absl::Duration silence, std::string advice)
    : silence_(silence), frames_(silence, std::move(advice)) {}

absl::Status FrameReceiver::Receive(const v1::PushFrameRequest& request, const std::string& peer,
                                    absl::Time arrival, MonotonicTime now) {
  ASSIGN_OR_RETURN(SensorFrame frame, PushedFrame(request, arrival, now));
  // Held while the frame is stored, so that an older one does not take the place of a newer one.
  const absl::MutexLock lock(&mutex_);
  const bool is_silent = now - last_ > silence_;
  if (camera_ != request.camera()) {
    if (!is_silent) {
      return absl::FailedPreconditionError(absl::StrCat("the frames of the camera ", camera_,
                                                        " come here; end the program that ",
                                                        "pushes them, or push to another agent"));
    }
    camera_ = request.camera();
    newest_ = MonotonicTime::InfinitePast();
  }
  if (frame.time < newest_) {
    return absl::AbortedError("a newer frame of this camera came before; push them in order");
  }
  if (is_silent) {
    spdlog::info("event=frames_pushed camera={} peer={}", LogField(camera_), LogField(peer));
  }
  newest_ = frame.time;
  last_ = now;
  frames_.Put(std::move(frame));
  return absl::OkStatus();
}

bool FrameReceiver::IsReady() const {
  const absl::MutexLock lock(&mutex_);
  return MonotonicTime::Now() - last_ < silence_;
}

}  // namespace graspdb::client
