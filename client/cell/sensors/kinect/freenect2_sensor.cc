#include "client/cell/sensors/kinect/freenect2_sensor.h"

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <libfreenect2/frame_listener.hpp>
#include <libfreenect2/libfreenect2.hpp>
#include <limits>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/sensors/frame_mailbox.h"
#include "client/cell/sensors/lens_table.h"
#include "files/messages/scan_message.h"

namespace graspdb::client {
namespace {

constexpr double kUnitM = 0.0001;
constexpr double kCountsPerMm = 0.001 / kUnitM;

// Receives depth frames on the library's threads.
class Listener : public libfreenect2::FrameListener {
 public:
  explicit Listener(absl::Duration silence) : frames_(silence) {}

  // Called once, after the start, when the intrinsics are known; frames may come already.
  void Calibrate(const recognition::CameraIntrinsics& camera,
                 const std::array<double, 5>& distortion) {
    camera_ = camera;
    table_ = LensTable(camera, distortion);
    is_calibrated_ = true;
  }

  // The library keeps ownership of the frame.
  bool onNewFrame(libfreenect2::Frame::Type type, libfreenect2::Frame* frame) override {
    if (!is_calibrated_ || type != libfreenect2::Frame::Depth || frame->status != 0) return false;
    if (frame->width != kKinectV2Width || frame->height != kKinectV2Height ||
        frame->bytes_per_pixel != sizeof(float)) {
      return false;
    }
    const MonotonicTime time = MonotonicTime::Now() - kExposureToArrival;
    const auto* depth_mm = reinterpret_cast<const float*>(frame->data);
    std::vector<std::uint16_t> counts;
    counts.reserve(table_.size());
    for (const std::int32_t pixel : table_) {
      counts.push_back(pixel < 0 ? std::uint16_t{0} : CountOf(depth_mm[pixel]));
    }
    SensorFrame out = {.scan = files::DepthMessage(counts, camera_, kUnitM)};
    SetTime(time, out);
    frames_.Put(std::move(out));
    return false;
  }

  FrameMailbox& frames() { return frames_; }

 private:
  // 0, not measured, for values that are not positive or NaN.
  static std::uint16_t CountOf(float depth_mm) {
    const double counts = std::round(static_cast<double>(depth_mm) * kCountsPerMm);
    const bool fits = counts > 0 && counts <= std::numeric_limits<std::uint16_t>::max();
    return fits ? static_cast<std::uint16_t>(counts) : std::uint16_t{0};
  }

  recognition::CameraIntrinsics camera_;
  std::vector<std::int32_t> table_;
  std::atomic<bool> is_calibrated_ = false;  // the members above are no longer written
  FrameMailbox frames_;
};

class Freenect2Sensor : public DepthSensor {
 public:
  explicit Freenect2Sensor(std::string serial) : serial_(std::move(serial)) {}
  ~Freenect2Sensor() override {
    if (device_ == nullptr) return;
    device_->stop();  // no call of the listener after this
    device_->close();
  }
  Freenect2Sensor(const Freenect2Sensor&) = delete;
  Freenect2Sensor& operator=(const Freenect2Sensor&) = delete;

  absl::Status Open(const SensorSettings& settings) {
    RETURN_IF_ERROR(CheckIntrinsics(settings, Name(), kKinectV2Width, kKinectV2Height));
    const int count = library_.enumerateDevices();
    if (serial_.empty() && count > 0) serial_ = library_.getDefaultDeviceSerialNumber();
    if (count > 0) device_ = library_.openDevice(serial_);
    if (device_ == nullptr) {
      return absl::UnavailableError(absl::StrCat(
          Name(), " cannot be opened, of ", count,
          " connected; check its power supply and its USB 3 cable, and libfreenect2's udev rules"));
    }
    listener_.emplace(settings.silence);
    device_->setIrAndDepthFrameListener(&*listener_);
    if (!device_->startStreams(/*rgb=*/false, /*depth=*/true)) return NoStart();
    const auto lens = device_->getIrCameraParams();
    const recognition::CameraIntrinsics camera = {.width = kKinectV2Width,
                                                  .height = kKinectV2Height,
                                                  .fx = static_cast<double>(lens.fx),
                                                  .fy = static_cast<double>(lens.fy),
                                                  .cx = static_cast<double>(lens.cx),
                                                  .cy = static_cast<double>(lens.cy)};
    if (!(camera.fx > 0 && camera.fy > 0)) return NoStart();
    const std::array<double, 5> distortion = {
        static_cast<double>(lens.k1), static_cast<double>(lens.k2), static_cast<double>(lens.p1),
        static_cast<double>(lens.p2), static_cast<double>(lens.k3)};
    listener_->Calibrate(settings.intrinsics.value_or(camera), distortion);
    return listener_->frames()
        .Wait(MonotonicTime::InfinitePast(), MonotonicTime::InfiniteFuture())
        .status();
  }

  absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) override {
    return listener_->frames().Wait(MonotonicTime::Now(), deadline);
  }
  bool IsReady() override { return listener_->frames().IsAlive(); }
  std::string Name() const override {
    return absl::StrCat("Kinect v2 (libfreenect2) ", serial_.empty() ? "no. 0" : serial_);
  }

 private:
  absl::Status NoStart() const {
    return absl::UnavailableError(
        absl::StrCat(Name(), " does not start; plug it into a USB 3 controller of its own"));
  }

  std::string serial_;
  // In this order: the library, which owns its devices, is destroyed before the listener.
  std::optional<Listener> listener_;
  libfreenect2::Freenect2 library_;
  libfreenect2::Freenect2Device* device_ = nullptr;
};

}  // namespace

absl::StatusOr<std::unique_ptr<DepthSensor>> OpenFreenect2(const std::string& serial,
                                                           const SensorSettings& settings) {
  auto sensor = std::make_unique<Freenect2Sensor>(serial);
  RETURN_IF_ERROR(sensor->Open(settings));
  return sensor;
}

std::vector<std::string> ListFreenect2() {
  libfreenect2::Freenect2 library;
  std::vector<std::string> serials;
  const int count = library.enumerateDevices();
  for (int i = 0; i < count; ++i) serials.push_back(library.getDeviceSerialNumber(i));
  return serials;
}

}  // namespace graspdb::client
