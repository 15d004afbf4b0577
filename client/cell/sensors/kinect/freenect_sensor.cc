#include "client/cell/sensors/kinect/freenect_sensor.h"

#include <dlfcn.h>
#include <libfreenect.h>
#include <libfreenect_registration.h>
#include <spdlog/spdlog.h>
#include <sys/time.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/sensors/frame_mailbox.h"
#include "client/cell/sensors/kinect/kinect_v1_calibration.h"
#include "files/messages/scan_message.h"
#include "program/log/log_field.h"

// fakenect, which replaces the library, lacks some of its functions.
#pragma weak freenect_copy_registration
#pragma weak freenect_destroy_registration
#pragma weak freenect_list_device_attributes
#pragma weak freenect_free_device_attributes

namespace graspdb::client {
namespace {

constexpr timeval kPoll = {.tv_sec = 0, .tv_usec = 100'000};
constexpr int kInterrupted = -10;  // LIBUSB_ERROR_INTERRUPTED: a signal, not an unplugged camera
constexpr std::size_t kPixels = std::size_t{kKinectV1Width} * kKinectV1Height;

// fakenect exits the process if it has nothing to play.
absl::Status CheckFakenect() {
  Dl_info library = {};
  if (dladdr(reinterpret_cast<const void*>(&freenect_init), &library) == 0 ||
      std::string(library.dli_fname).find("fakenect") == std::string::npos) {
    return absl::OkStatus();
  }
  const char* recording = std::getenv("FAKENECT_PATH");
  std::error_code error;
  if (recording != nullptr &&
      std::filesystem::is_regular_file(std::filesystem::path(recording) / "INDEX.txt", error)) {
    return absl::OkStatus();
  }
  return absl::FailedPreconditionError(
      "this program runs on fakenect, which has no recording; set FAKENECT_PATH to the folder of "
      "one, or start the program without fakenect");
}

void Log(freenect_context* /*context*/, freenect_loglevel level, const char* text) {
  const auto line = absl::StripTrailingAsciiWhitespace(text);
  spdlog::log(level <= FREENECT_LOG_ERROR ? spdlog::level::warn : spdlog::level::debug,
              "event=libfreenect text={}", LogField(std::string(line)));
}

// The library's handles, closed in their order.
class Handles {
 public:
  Handles() = default;
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;
  ~Handles() {
    if (device != nullptr) {
      freenect_stop_depth(device);
      freenect_close_device(device);
    }
    if (context != nullptr) freenect_shutdown(context);
  }

  absl::Status Start() {
    RETURN_IF_ERROR(CheckFakenect());
    if (freenect_init(&context, nullptr) < 0) {
      context = nullptr;
      return absl::UnavailableError(
          "libfreenect cannot start; is USB (/dev/bus/usb) there for this program?");
    }
    freenect_set_log_callback(context, Log);
    freenect_set_log_level(context, FREENECT_LOG_WARNING);
    freenect_select_subdevices(context, FREENECT_DEVICE_CAMERA);  // not motor and microphones
    return absl::OkStatus();
  }

  freenect_context* context = nullptr;
  freenect_device* device = nullptr;
};

// The device's own calibration, which Debian 12's fakenect does not provide.
KinectV1Calibration CalibrationOf(freenect_device* device) {
  KinectV1Calibration calibration;
  if (&freenect_copy_registration == nullptr || &freenect_destroy_registration == nullptr) {
    return calibration;
  }
  freenect_registration registration = freenect_copy_registration(device);
  const freenect_zero_plane_info& plane = registration.zero_plane_info;  // centimetres
  if (plane.reference_distance > 0 && plane.reference_pixel_size > 0 &&
      plane.dcmos_emitter_dist > 0 && registration.const_shift > 0) {
    calibration = {.reference_distance_m = 0.01 * static_cast<double>(plane.reference_distance),
                   .reference_pixel_m = 0.01 * static_cast<double>(plane.reference_pixel_size),
                   .baseline_m = 0.01 * static_cast<double>(plane.dcmos_emitter_dist),
                   .const_shift = registration.const_shift};
  } else {
    spdlog::warn("event=kinect_v1_without_calibration taken=\"values of most devices\"");
  }
  freenect_destroy_registration(&registration);
  return calibration;
}

class FreenectSensor : public DepthSensor {
 public:
  FreenectSensor(std::string which, const SensorSettings& settings)
      : which_(std::move(which)), settings_(settings) {}
  ~FreenectSensor() override {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }
  FreenectSensor(const FreenectSensor&) = delete;
  FreenectSensor& operator=(const FreenectSensor&) = delete;

  absl::Status Open() {
    RETURN_IF_ERROR(CheckIntrinsics(settings_, Name(), kKinectV1Width, kKinectV1Height));
    RETURN_IF_ERROR(handles_.Start());
    RETURN_IF_ERROR(OpenDevice());
    RETURN_IF_ERROR(StartDepth());
    frames_.emplace(settings_.silence);  // only now, because opening is slow
    thread_ = std::thread([this] { Receive(); });
    // A camera without frames counts as not open.
    return frames_->Wait(MonotonicTime::InfinitePast(), MonotonicTime::InfiniteFuture()).status();
  }

  absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) override {
    return frames_->Wait(MonotonicTime::Now(), deadline);
  }
  bool IsReady() override { return frames_->IsAlive(); }
  std::string Name() const override {
    return absl::StrCat("Kinect v1 (libfreenect) no. ", which_.empty() ? "0" : which_);
  }

 private:
  absl::Status OpenDevice() {
    const int count = freenect_num_devices(handles_.context);
    int number = 0;
    // Serial numbers are longer than camera numbers.
    const bool by_serial = which_.size() > 2;
    if (!by_serial && !which_.empty() && !absl::SimpleAtoi(which_, &number)) number = -1;
    if (count < 1 || (!by_serial && (number < 0 || number >= count))) {
      return absl::UnavailableError(
          absl::StrCat(Name(), " is not there, of ", std::max(count, 0),
                       " connected; check its USB cable and its power supply, and count from 0"));
    }
    const int opened = by_serial ? freenect_open_device_by_camera_serial(
                                       handles_.context, &handles_.device, which_.c_str())
                                 : freenect_open_device(handles_.context, &handles_.device, number);
    if (opened >= 0) return absl::OkStatus();
    handles_.device = nullptr;
    return absl::UnavailableError(
        absl::StrCat(Name(),
                     " cannot be opened; is it used by another program, is the kernel's module "
                     "gspca_kinect loaded, or is this user not in the group plugdev?"));
  }

  absl::Status StartDepth() {
    const freenect_frame_mode mode =
        freenect_find_depth_mode(FREENECT_RESOLUTION_MEDIUM, FREENECT_DEPTH_11BIT);
    freenect_set_user(handles_.device, this);
    freenect_set_depth_callback(handles_.device, OnDepth);
    if (mode.is_valid == 0 || mode.bytes != static_cast<int>(2 * kPixels) ||
        freenect_set_depth_mode(handles_.device, mode) < 0 ||
        freenect_start_depth(handles_.device) < 0) {
      return absl::UnavailableError(
          absl::StrCat(Name(), " does not start; plug it into a USB controller of its own"));
    }
    const KinectV1Calibration calibration = CalibrationOf(handles_.device);
    depths_ = DepthOfRaw(calibration);
    intrinsics_ = settings_.intrinsics.value_or(KinectV1Intrinsics(calibration));
    return absl::OkStatus();
  }

  // Runs until the sensor is destroyed; calls the library's callbacks.
  void Receive() {
    while (!stopping_) {
      timeval poll = kPoll;
      const int result = freenect_process_events_timeout(handles_.context, &poll);
      if (result >= 0 || result == kInterrupted) continue;
      frames_->Fail(
          absl::UnavailableError(absl::StrCat(Name(), " was unplugged (error ", result,
                                              ", or the end of a recording); plug it in again")));
      return;
    }
  }

  static void OnDepth(freenect_device* device, void* depth, std::uint32_t /*ticks*/) {
    static_cast<FreenectSensor*>(freenect_get_user(device))->Take(depth);
  }

  // `raw`: kPixels disparities of 16 bits, which fakenect does not align.
  void Take(const void* raw) {
    const MonotonicTime time = MonotonicTime::Now() - kExposureToArrival;
    std::vector<std::uint16_t> counts(kPixels);
    std::memcpy(counts.data(), raw, kPixels * sizeof(std::uint16_t));
    for (std::uint16_t& count : counts) {
      count = count < kKinectV1RawValues ? depths_[count] : std::uint16_t{0};
    }
    SensorFrame frame = {.scan = files::DepthMessage(counts, intrinsics_, kKinectV1DepthUnitM)};
    SetTime(time, frame);
    frames_->Put(std::move(frame));
  }

  const std::string which_;
  const SensorSettings settings_;
  Handles handles_;
  std::array<std::uint16_t, kKinectV1RawValues> depths_ = {};
  recognition::CameraIntrinsics intrinsics_;
  std::optional<FrameMailbox> frames_;  // from Open on
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<DepthSensor>> OpenFreenect(const std::string& which,
                                                          const SensorSettings& settings) {
  auto sensor = std::make_unique<FreenectSensor>(which, settings);
  RETURN_IF_ERROR(sensor->Open());
  return sensor;
}

absl::StatusOr<std::vector<std::string>> ListFreenect() {
  Handles handles;
  RETURN_IF_ERROR(handles.Start());
  std::vector<std::string> names;
  if (&freenect_list_device_attributes != nullptr && &freenect_free_device_attributes != nullptr) {
    freenect_device_attributes* cameras = nullptr;
    if (freenect_list_device_attributes(handles.context, &cameras) > 0) {
      for (const auto* camera = cameras; camera != nullptr; camera = camera->next) {
        names.emplace_back(camera->camera_serial);
      }
      freenect_free_device_attributes(cameras);
      return names;
    }
  }
  for (int i = 0; i < freenect_num_devices(handles.context); ++i) names.push_back(absl::StrCat(i));
  return names;
}

}  // namespace graspdb::client
