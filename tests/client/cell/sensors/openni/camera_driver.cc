// A driver of OpenNI 2 for a camera that is not there: the library loads it in the place of the
// drivers of real ones, so that everything but those is tested. The camera at the URI
// "Test/Ramp" shows a depth in millimetres of 500 + column, mirrored by default. After
// $GRASPDB_TEST_CAMERA_FRAMES frames, if set, it is unplugged, once; a moment later it is
// reconnected. If $GRASPDB_TEST_OTHER_CAMERA_FRAMES is set, another camera beside it,
// which cannot be opened, is unplugged for good after so many of its frames.
#include <Driver/OniDriverAPI.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <thread>

// The macro that exports a driver uses these, which the package does not define.
#define XN_NEW(type, services) new type(services)
#define XN_DELETE(pointer) delete pointer

namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr int kStride = kWidth * static_cast<int>(sizeof(OniDepthPixel));
constexpr float kHorizontalFieldOfView = 1.0F;
constexpr float kVerticalFieldOfView = 0.75F;
constexpr auto kFrameTime = std::chrono::milliseconds(5);
constexpr auto kUnpluggedTime = std::chrono::milliseconds(50);
constexpr int kProperties[] = {ONI_STREAM_PROPERTY_VIDEO_MODE,     ONI_STREAM_PROPERTY_STRIDE,
                               ONI_STREAM_PROPERTY_HORIZONTAL_FOV, ONI_STREAM_PROPERTY_VERTICAL_FOV,
                               ONI_STREAM_PROPERTY_MIRRORING,      ONI_STREAM_PROPERTY_CROPPING,
                               ONI_STREAM_PROPERTY_MAX_VALUE};

OniVideoMode TheMode() {
  return {.pixelFormat = ONI_PIXEL_FORMAT_DEPTH_1_MM,
          .resolutionX = kWidth,
          .resolutionY = kHeight,
          .fps = 30};
}

template <typename T>
OniStatus Give(const T& value, void* data, int* size) {
  if (*size < static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
  *size = static_cast<int>(sizeof(T));
  std::memcpy(data, &value, sizeof(T));
  return ONI_STATUS_OK;
}

class Stream : public oni::driver::StreamBase {
 public:
  explicit Stream(std::function<bool()> is_plugged) : is_plugged_(std::move(is_plugged)) {}
  ~Stream() override { stop(); }

  OniStatus start() override {
    running_ = true;
    thread_ = std::thread([this] { Run(); });
    return ONI_STATUS_OK;
  }
  void stop() override {
    running_ = false;
    if (thread_.joinable()) thread_.join();
  }

  OniStatus getProperty(int id, void* data, int* size) override {
    switch (id) {
      case ONI_STREAM_PROPERTY_VIDEO_MODE:
        return Give(TheMode(), data, size);
      case ONI_STREAM_PROPERTY_STRIDE:
        return Give(kStride, data, size);
      case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
        return Give(kHorizontalFieldOfView, data, size);
      case ONI_STREAM_PROPERTY_VERTICAL_FOV:
        return Give(kVerticalFieldOfView, data, size);
      case ONI_STREAM_PROPERTY_MIRRORING:
        return Give(static_cast<OniBool>(mirrored_ ? 1 : 0), data, size);
      case ONI_STREAM_PROPERTY_CROPPING:
        return Give(OniCropping{}, data, size);
      case ONI_STREAM_PROPERTY_MAX_VALUE:
        return Give(10000, data, size);
      default:
        return ONI_STATUS_NOT_SUPPORTED;
    }
  }
  OniStatus setProperty(int id, const void* data, int size) override {
    if (id != ONI_STREAM_PROPERTY_MIRRORING || size != static_cast<int>(sizeof(OniBool))) {
      return ONI_STATUS_NOT_SUPPORTED;
    }
    OniBool mirrored = 0;
    std::memcpy(&mirrored, data, sizeof(mirrored));
    mirrored_ = mirrored != 0;
    return ONI_STATUS_OK;
  }
  OniBool isPropertySupported(int id) override {
    for (const int known : kProperties) {
      if (known == id) return 1;
    }
    return 0;
  }
  // Recorders store the properties that are returned here.
  void notifyAllProperties() override {
    char value[256];
    for (const int id : kProperties) {
      int size = sizeof(value);
      if (getProperty(id, value, &size) == ONI_STATUS_OK) raisePropertyChanged(id, value, size);
    }
  }

 private:
  void Run() {
    for (int number = 1; running_; ++number) {
      std::this_thread::sleep_for(kFrameTime);
      if (is_plugged_()) Show(number);
    }
  }

  void Show(int number) {
    OniFrame* const frame = getServices().acquireFrame();
    if (frame == nullptr) return;
    auto* const depths = static_cast<OniDepthPixel*>(frame->data);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        depths[v * kWidth + u] = static_cast<OniDepthPixel>(500 + (mirrored_ ? kWidth - 1 - u : u));
      }
    }
    frame->frameIndex = number;
    frame->videoMode = TheMode();
    frame->width = kWidth;
    frame->height = kHeight;
    frame->cropOriginX = frame->cropOriginY = 0;
    frame->croppingEnabled = 0;
    frame->sensorType = ONI_SENSOR_DEPTH;
    frame->stride = kStride;
    frame->dataSize = kStride * kHeight;
    frame->timestamp = static_cast<uint64_t>(number) * 33'333U;
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
  }

  const std::function<bool()> is_plugged_;
  std::atomic<bool> mirrored_ = true;
  std::atomic<bool> running_ = false;
  std::thread thread_;
};

class Device : public oni::driver::DeviceBase {
 public:
  explicit Device(std::function<bool()> is_plugged) : is_plugged_(std::move(is_plugged)) {}

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override {
    *sensors = &depth_;
    *count = 1;
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType type) override {
    return type == ONI_SENSOR_DEPTH ? new Stream(is_plugged_) : nullptr;
  }
  void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }

 private:
  const std::function<bool()> is_plugged_;
  OniVideoMode mode_ = TheMode();
  OniSensorInfo depth_ = {
      .sensorType = ONI_SENSOR_DEPTH, .numSupportedVideoModes = 1, .pSupportedVideoModes = &mode_};
};

class Driver : public oni::driver::DriverBase {
 public:
  explicit Driver(OniDriverServices* services) : DriverBase(services) {
    std::strcpy(info_.uri, "Test/Ramp");
    std::strcpy(info_.vendor, "tests");
    std::strcpy(info_.name, "ramp");
    const char* frames = std::getenv("GRASPDB_TEST_CAMERA_FRAMES");
    frames_left_ = frames == nullptr ? -1 : std::stoi(frames);
    std::strcpy(other_.uri, "Test/Beside");
    std::strcpy(other_.vendor, "tests");
    std::strcpy(other_.name, "beside");
    const char* until = std::getenv("GRASPDB_TEST_OTHER_CAMERA_FRAMES");
    frames_until_other_goes_ = until == nullptr ? -1 : std::stoi(until);
  }
  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    DriverBase::initialize(connected, disconnected, changed, cookie);
    deviceConnected(&info_);
    if (frames_until_other_goes_ >= 0) deviceConnected(&other_);
    return ONI_STATUS_OK;
  }
  oni::driver::DeviceBase* deviceOpen(const char* uri, const char* /*mode*/) override {
    if (!plugged_ || std::strcmp(uri, info_.uri) != 0) return nullptr;
    return new Device([this] { return TakeFrame(); });
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }
  void shutdown() override {}

 private:
  // Whether a frame is left.
  bool TakeFrame() {
    if (!plugged_) return false;
    if (frames_until_other_goes_ >= 0 && frames_until_other_goes_-- == 0) {
      std::thread([this] { deviceDisconnected(&other_); }).detach();
    }
    if (frames_left_ < 0 || frames_left_-- > 0) return true;
    plugged_ = false;
    // Never joined: the library and its drivers stay loaded until the program ends.
    std::thread hand([this] {
      deviceDisconnected(&info_);
      std::this_thread::sleep_for(kUnpluggedTime);
      plugged_ = true;
      deviceConnected(&info_);
    });
    hand.detach();
    return false;
  }

  OniDeviceInfo info_ = {};
  OniDeviceInfo other_ = {};
  std::atomic<int> frames_until_other_goes_ = -1;  // below 0: not connected
  std::atomic<int> frames_left_ = -1;              // below 0: unlimited
  std::atomic<bool> plugged_ = true;
};

}  // namespace

ONI_EXPORT_DRIVER(Driver)
