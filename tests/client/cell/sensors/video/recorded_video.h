// A video device that plays recorded buffers.
#pragma once

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "client/cell/sensors/video/video_calls.h"

namespace graspdb::client {

// What the driver does, as the kernel's documentation of Video4Linux has it.
struct RecordedCamera {
  std::string product = "Intel(R) RealSense(TM) Depth Camera 435";
  std::string card = "Intel(R) RealSense(TM) Depth Ca";
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::uint32_t pixel_format = V4L2_PIX_FMT_Z16;
  // The only size, and its rows.
  std::uint32_t width = 4;
  std::uint32_t height = 3;
  std::uint32_t bytes_per_line = 8;
  int stream_error = 0;  // of VIDIOC_STREAMON
};

struct RecordedBuffer {
  std::string bytes;
  std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  absl::Duration timestamp = absl::ZeroDuration();  // of the monotonic clock
};

// Buffers may be given while it plays. After them it repeats one, is silent, or unplugged.
class RecordedVideo : public VideoCalls {
 public:
  explicit RecordedVideo(RecordedCamera camera) : camera_(std::move(camera)) {}

  void Play(RecordedBuffer buffer) {
    const absl::MutexLock lock(&mutex_);
    recorded_.push_back(std::move(buffer));
    changed_.SignalAll();
  }
  void Repeat(RecordedBuffer buffer) {
    const absl::MutexLock lock(&mutex_);
    repeated_ = std::move(buffer);
    changed_.SignalAll();
  }
  void Unplug() {
    const absl::MutexLock lock(&mutex_);
    is_unplugged_ = true;
    changed_.SignalAll();
  }

  int Control(unsigned long request, void* argument) override {
    const absl::MutexLock lock(&mutex_);
    switch (request) {
      case VIDIOC_QUERYCAP:
        return QueryCapabilities(*static_cast<v4l2_capability*>(argument));
      case VIDIOC_ENUM_FMT:
        return EnumerateFormats(*static_cast<v4l2_fmtdesc*>(argument));
      case VIDIOC_S_FMT:
        return SetFormat(*static_cast<v4l2_format*>(argument));
      case VIDIOC_REQBUFS:
        static_cast<v4l2_requestbuffers*>(argument)->count = kBuffers;
        return 0;
      case VIDIOC_QUERYBUF:
        return QueryBuffer(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_QBUF:
        queued_.push_back(static_cast<v4l2_buffer*>(argument)->index);
        changed_.SignalAll();
        return 0;
      case VIDIOC_DQBUF:
        return Dequeue(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_STREAMON:
        return camera_.stream_error;
      case VIDIOC_STREAMOFF:
        return 0;
      default:
        return ENOTTY;
    }
  }

  std::string Product() override { return camera_.product; }

  const void* Map(std::size_t length, std::size_t offset) override {
    return length == kLength && offset % kLength == 0 ? memory_[offset / kLength].data() : nullptr;
  }

  bool Wait(int timeout_ms) override {
    const absl::Time deadline = absl::Now() + absl::Milliseconds(timeout_ms);
    const absl::MutexLock lock(&mutex_);
    // No absl::Condition: the thread sanitizer does not see the lock that guards its evaluation.
    while (!IsReady() && !changed_.WaitWithDeadline(&mutex_, deadline)) {
    }
    return IsReady();
  }

 private:
  static constexpr std::size_t kLength = 64;
  static constexpr std::uint32_t kBuffers = 3;  // fewer than requested

  bool IsReady() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return is_unplugged_ || ((repeated_ || !recorded_.empty()) && !queued_.empty());
  }

  int QueryCapabilities(v4l2_capability& out) const {
    std::memcpy(out.card, camera_.card.data(), std::min(camera_.card.size(), sizeof(out.card)));
    out.capabilities = camera_.capabilities | V4L2_CAP_DEVICE_CAPS | V4L2_CAP_META_CAPTURE;
    out.device_caps = camera_.capabilities;
    return 0;
  }

  int EnumerateFormats(v4l2_fmtdesc& out) const {
    if (out.index > 1) return EINVAL;
    out.pixelformat = out.index == 0 ? V4L2_PIX_FMT_GREY : camera_.pixel_format;
    return 0;
  }

  int SetFormat(v4l2_format& out) const {
    out.fmt.pix.width = camera_.width;
    out.fmt.pix.height = camera_.height;
    out.fmt.pix.bytesperline = camera_.bytes_per_line;
    out.fmt.pix.sizeimage = camera_.bytes_per_line * camera_.height;
    return 0;
  }

  int QueryBuffer(v4l2_buffer& out) const {
    if (out.index >= memory_.size()) return EINVAL;
    out.length = kLength;
    out.m.offset = static_cast<std::uint32_t>(kLength * out.index);
    return 0;
  }

  int Dequeue(v4l2_buffer& out) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (is_unplugged_) return ENODEV;
    if ((recorded_.empty() && !repeated_) || queued_.empty()) return EAGAIN;
    RecordedBuffer buffer;
    if (recorded_.empty()) {
      buffer = *repeated_;
    } else {
      buffer = std::move(recorded_.front());
      recorded_.pop_front();
    }
    out.index = queued_.front();
    queued_.pop_front();
    std::memcpy(memory_[out.index].data(), buffer.bytes.data(),
                std::min(buffer.bytes.size(), kLength));
    out.bytesused = static_cast<std::uint32_t>(buffer.bytes.size());
    out.flags = buffer.flags;
    out.timestamp = absl::ToTimeval(buffer.timestamp);
    return 0;
  }

  const RecordedCamera camera_;
  absl::Mutex mutex_;
  absl::CondVar changed_;
  std::deque<RecordedBuffer> recorded_ ABSL_GUARDED_BY(mutex_);
  std::optional<RecordedBuffer> repeated_ ABSL_GUARDED_BY(mutex_);
  std::deque<std::uint32_t> queued_ ABSL_GUARDED_BY(mutex_);
  bool is_unplugged_ ABSL_GUARDED_BY(mutex_) = false;
  std::array<std::array<char, kLength>, kBuffers> memory_ = {};
};

}  // namespace graspdb::client
