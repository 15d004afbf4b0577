#include "client/cell/sensors/openni/openni2_sensor.h"

#include <OpenNI.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/sensors/frame_mailbox.h"
#include "files/messages/scan_message.h"
#include "program/log/log_field.h"

namespace graspdb::client {
namespace {

constexpr int kPollMs = 100;
constexpr int kWantedWidth = 640;

// The library's message for the last error, in one line.
std::string Reason() {
  return std::string(absl::StripAsciiWhitespace(openni::OpenNI::getExtendedError()));
}

// The library is started once per process; it does not support a restart.
absl::Status StartLibrary() {
  static const openni::Status started = openni::OpenNI::initialize();
  if (started == openni::STATUS_OK) return absl::OkStatus();
  return absl::UnavailableError(absl::StrCat(
      "OpenNI 2 cannot start (", Reason(), "); are its drivers installed (package libopenni2-0)?"));
}

double UnitOf(openni::PixelFormat format) {
  if (format == openni::PIXEL_FORMAT_DEPTH_1_MM) return 0.001;
  return format == openni::PIXEL_FORMAT_DEPTH_100_UM ? 0.0001 : 0;
}

// Prefers the width nearest to 640, then the higher frame rate.
bool IsBetter(const openni::VideoMode& a, const openni::VideoMode& b) {
  const int far_a = std::abs(a.getResolutionX() - kWantedWidth);
  const int far_b = std::abs(b.getResolutionX() - kWantedWidth);
  return far_a != far_b ? far_a < far_b : a.getFps() > b.getFps();
}

class OpenNi2Sensor : public DepthSensor, private openni::OpenNI::DeviceDisconnectedListener {
 public:
  OpenNi2Sensor(std::string uri, const SensorSettings& settings)
      : uri_(std::move(uri)), settings_(settings) {}
  ~OpenNi2Sensor() override {
    openni::OpenNI::removeDeviceDisconnectedListener(this);
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
    stream_.stop();
    stream_.destroy();
    device_.close();
  }
  OpenNi2Sensor(const OpenNi2Sensor&) = delete;
  OpenNi2Sensor& operator=(const OpenNi2Sensor&) = delete;

  absl::Status Open(bool loop) {
    if (device_.open(uri_.empty() ? openni::ANY_DEVICE : uri_.c_str()) != openni::STATUS_OK) {
      return absl::UnavailableError(
          absl::StrCat(Name(), " cannot be opened (", Reason(),
                       "); check its cable, and that this user may use it (group plugdev)"));
    }
    opened_uri_ = device_.getDeviceInfo().getUri();
    RETURN_IF_ERROR(CreateStream());
    RETURN_IF_ERROR(Calibrate());
    if (device_.isFile()) device_.getPlaybackControl()->setRepeatEnabled(loop);
    frames_.emplace(settings_.silence);
    openni::OpenNI::addDeviceDisconnectedListener(this);
    if (stream_.start() != openni::STATUS_OK) {
      return absl::UnavailableError(
          absl::StrCat(Name(), " does not start (", Reason(), "); plug it in again"));
    }
    if (device_.isFile() && !loop) {
      last_frame_ = device_.getPlaybackControl()->getNumberOfFrames(stream_);
    }
    thread_ = std::thread([this] { Receive(); });
    return frames_->Wait(MonotonicTime::InfinitePast(), MonotonicTime::InfiniteFuture()).status();
  }

  absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) override {
    return frames_->Wait(MonotonicTime::Now(), deadline);
  }
  bool IsReady() override { return frames_->IsAlive(); }
  bool HasEnded() override { return has_ended_; }
  std::string Name() const override {
    return uri_.empty() ? "any camera of OpenNI 2" : absl::StrCat("OpenNI 2 camera ", uri_);
  }

 private:
  absl::Status CreateStream() {
    if (!device_.hasSensor(openni::SENSOR_DEPTH) ||
        stream_.create(device_, openni::SENSOR_DEPTH) != openni::STATUS_OK) {
      return absl::FailedPreconditionError(
          absl::StrCat(Name(), " has no depth camera; choose another device"));
    }
    if (device_.isFile()) return absl::OkStatus();
    const auto& modes = stream_.getSensorInfo().getSupportedVideoModes();
    const openni::VideoMode* best = nullptr;
    for (int i = 0; i < modes.getSize(); ++i) {
      if (UnitOf(modes[i].getPixelFormat()) == 0) continue;
      if (best == nullptr || IsBetter(modes[i], *best)) best = &modes[i];
    }
    // A device with one mode may reject setting it.
    if (best != nullptr && stream_.setVideoMode(*best) != openni::STATUS_OK) {
      spdlog::debug("event=openni2_mode_kept reason={}", LogField(Reason()));
    }
    stream_.setMirroringEnabled(false);
    return absl::OkStatus();
  }

  absl::Status Calibrate() {
    const openni::VideoMode mode = stream_.getVideoMode();
    unit_m_ = UnitOf(mode.getPixelFormat());
    const double width = mode.getResolutionX();
    const double height = mode.getResolutionY();
    const auto horizontal = static_cast<double>(stream_.getHorizontalFieldOfView());
    const auto vertical = static_cast<double>(stream_.getVerticalFieldOfView());
    if (unit_m_ == 0) {
      return absl::FailedPreconditionError(
          absl::StrCat(Name(), " has no depths in millimetres; choose another camera"));
    }
    RETURN_IF_ERROR(
        CheckIntrinsics(settings_, Name(), mode.getResolutionX(), mode.getResolutionY()));
    if (settings_.intrinsics) {
      intrinsics_ = *settings_.intrinsics;
    } else if (horizontal > 0 && vertical > 0) {
      intrinsics_ = {.width = mode.getResolutionX(),
                     .height = mode.getResolutionY(),
                     .fx = width / 2 / std::tan(horizontal / 2),
                     .fy = height / 2 / std::tan(vertical / 2),
                     .cx = (width - 1) / 2,
                     .cy = (height - 1) / 2};
    } else {
      return absl::FailedPreconditionError(
          absl::StrCat(Name(),
                       " does not report its field of view; give its intrinsics, "
                       "?fx=F&fy=F&cx=X&cy=Y"));
    }
    return absl::OkStatus();
  }

  void onDeviceDisconnected(const openni::DeviceInfo* device) override {
    if (opened_uri_ != device->getUri()) return;
    frames_->Fail(absl::UnavailableError(absl::StrCat(Name(), " was unplugged; plug it in again")));
  }

  void Receive() {
    openni::VideoStream* const streams[] = {&stream_};
    while (!stopping_) {
      int ready = 0;
      // The mailbox reports a camera without frames.
      if (openni::OpenNI::waitForAnyStream(const_cast<openni::VideoStream**>(streams), 1, &ready,
                                           kPollMs) != openni::STATUS_OK) {
        continue;
      }
      openni::VideoFrameRef frame;
      if (stream_.readFrame(&frame) != openni::STATUS_OK || !frame.isValid()) continue;
      if (!Take(frame)) return;
      if (last_frame_ && frame.getFrameIndex() >= *last_frame_) {
        has_ended_ = true;
        frames_->Fail(absl::UnavailableError(
            absl::StrCat(Name(), ": the recording is at its end; add ?loop to start again")));
        return;
      }
    }
  }

  bool Take(const openni::VideoFrameRef& frame) {
    const MonotonicTime arrival = MonotonicTime::Now();
    if (frame.getWidth() != intrinsics_.width || frame.getHeight() != intrinsics_.height) {
      frames_->Fail(absl::FailedPreconditionError(
          absl::StrCat(Name(), " has ", frame.getWidth(), " x ", frame.getHeight(),
                       " pixels and its intrinsics ", intrinsics_.width, " x ", intrinsics_.height,
                       "; correct them")));
      return false;
    }
    const auto width = static_cast<std::size_t>(frame.getWidth());
    const bool mirrored = stream_.getMirroringEnabled();  // recordings may be
    std::vector<std::uint16_t> counts;
    counts.reserve(width * static_cast<std::size_t>(frame.getHeight()));
    for (int v = 0; v < frame.getHeight(); ++v) {
      const auto* row = reinterpret_cast<const openni::DepthPixel*>(
          static_cast<const char*>(frame.getData()) +
          static_cast<std::ptrdiff_t>(v) * frame.getStrideInBytes());
      if (mirrored) {
        counts.insert(counts.end(), std::reverse_iterator(row + width), std::reverse_iterator(row));
      } else {
        counts.insert(counts.end(), row, row + width);
      }
    }
    SensorFrame out = {.scan = files::DepthMessage(counts, intrinsics_, unit_m_)};
    SetTime(device_.isFile() ? arrival : arrival - kExposureToArrival, out);
    frames_->Put(std::move(out));
    return true;
  }

  const std::string uri_;   // as requested; empty: any
  std::string opened_uri_;  // of the opened device, set by Open
  const SensorSettings settings_;
  openni::Device device_;
  openni::VideoStream stream_;
  double unit_m_ = 0.001;
  recognition::CameraIntrinsics intrinsics_;
  std::optional<int> last_frame_;       // of a recording that is not looped
  std::optional<FrameMailbox> frames_;  // from Open on
  std::atomic<bool> has_ended_ = false;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<DepthSensor>> OpenOpenNi2(const std::string& uri, bool loop,
                                                         const SensorSettings& settings) {
  std::error_code error;
  if (absl::EndsWithIgnoreCase(uri, ".oni") && !std::filesystem::exists(uri, error)) {
    return absl::NotFoundError(absl::StrCat(uri, " does not exist; give a recording of OpenNI 2"));
  }
  RETURN_IF_ERROR(StartLibrary());
  auto sensor = std::make_unique<OpenNi2Sensor>(uri, settings);
  RETURN_IF_ERROR(sensor->Open(loop));
  return sensor;
}

absl::StatusOr<std::vector<std::string>> ListOpenNi2() {
  RETURN_IF_ERROR(StartLibrary());
  openni::Array<openni::DeviceInfo> devices;
  openni::OpenNI::enumerateDevices(&devices);
  std::vector<std::string> uris;
  uris.reserve(static_cast<std::size_t>(devices.getSize()));
  for (int i = 0; i < devices.getSize(); ++i) uris.emplace_back(devices[i].getUri());
  return uris;
}

}  // namespace graspdb::client
