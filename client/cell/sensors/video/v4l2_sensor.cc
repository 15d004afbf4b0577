#include "client/cell/sensors/video/v4l2_sensor.h"

#include <linux/videodev2.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/sensors/frame_mailbox.h"
#include "files/messages/scan_message.h"
#include "program/log/log_field.h"

namespace graspdb::client {
namespace {

static_assert(std::endian::native == std::endian::little, "Z16 is little-endian");

constexpr std::size_t kBytesOfPixel = 2;

struct Model {
  const char* name;  // a part of the product's name; the first that fits counts
  double unit_m;
};

// The default depth units of Intel's SDK (RS2_OPTION_DEPTH_UNITS).
constexpr Model kModels[] = {
    {"RealSense(TM) Depth Camera 405", 0.0001},
    {"RealSense(TM) Depth Camera 4", 0.001},
    {"L515", 0.00025},
    {"SR300", 0.000125},
    {"SR305", 0.000125},
};

// Images that the driver fills while one is read.
constexpr std::uint32_t kBufferCount = 4;
// How often the reading thread looks whether it is to end.
constexpr int kPollMs = 100;

// The text of a fixed array, which need not end with 0.
template <std::size_t size>
std::string TextOf(const __u8 (&bytes)[size]) {
  const auto* text = reinterpret_cast<const char*>(bytes);
  return {text, strnlen(text, size)};
}

// The capabilities of the opened node, or of the device in old drivers.
std::uint32_t CapabilitiesOf(const v4l2_capability& device) {
  const bool has_own = (device.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
  return has_own ? device.device_caps : device.capabilities;
}

bool HasZ16(VideoCalls& video) {
  v4l2_fmtdesc format = {};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  while (video.Control(VIDIOC_ENUM_FMT, &format) == 0) {
    if (format.pixelformat == V4L2_PIX_FMT_Z16) return true;
    ++format.index;
  }
  return false;
}

class V4l2Sensor : public DepthSensor {
 public:
  V4l2Sensor(const std::string& path, std::unique_ptr<VideoCalls> video, const V4l2Options& options,
             const SensorSettings& settings)
      : path_(path),
        options_(options),
        name_(absl::StrCat("V4L2 camera ", path)),
        silence_(settings.silence),
        video_(std::move(video)) {
    if (settings.intrinsics) camera_ = *settings.intrinsics;
  }

  ~V4l2Sensor() override {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (frames_) video_->Control(VIDIOC_STREAMOFF, &type);
  }
  V4l2Sensor(const V4l2Sensor&) = delete;
  V4l2Sensor& operator=(const V4l2Sensor&) = delete;

  absl::Status Open() {
    RETURN_IF_ERROR(ReadModel());
    RETURN_IF_ERROR(SetFormat());
    RETURN_IF_ERROR(MapBuffers());
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    RETURN_IF_ERROR(Call("VIDIOC_STREAMON", VIDIOC_STREAMON, &type));
    frames_.emplace(silence_);
    thread_ = std::thread([this] { Run(); });
    return absl::OkStatus();
  }

  absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) override {
    return frames_->Wait(MonotonicTime::Now(), deadline);
  }
  bool IsReady() override { return frames_->IsAlive(); }
  std::string Name() const override { return name_; }

 private:
  absl::Status Unusable(const std::string& what) const {
    return absl::FailedPreconditionError(absl::StrCat(name_, " ", what));
  }

  absl::Status Call(const char* what, unsigned long request, void* argument) {
    const int error = video_->Control(request, argument);
    if (error == 0) return absl::OkStatus();
    return absl::UnavailableError(absl::StrCat(name_, ": ", what, " failed (", std::strerror(error),
                                               "); is another program using the camera?"));
  }

  absl::Status ReadModel() {
    v4l2_capability device = {};
    if (video_->Control(VIDIOC_QUERYCAP, &device) != 0) return Unusable("is no video device");
    std::string model = video_->Product();
    if (model.empty()) model = TextOf(device.card);
    name_ = absl::StrCat(model, " (V4L2) at ", path_);
    constexpr std::uint32_t kRequired = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    if ((CapabilitiesOf(device) & kRequired) != kRequired || !HasZ16(*video_)) {
      return Unusable(
          "has no depth images (Z16); another node of the camera may have them, list them with "
          "graspdb sensors list");
    }
    const std::optional<double> unit = options_.unit_m ? options_.unit_m : DepthUnitOfModel(model);
    if (!unit) return Unusable("is no known model; give its metres a count, such as ?unit=0.001");
    unit_m_ = *unit;
    if (camera_.width > 0) return absl::OkStatus();
    return Unusable("needs intrinsics; give fx, fy, cx, cy, width and height, or intrinsics=FILE");
  }

  absl::Status SetFormat() {
    v4l2_format format = {};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    format.fmt.pix.width = static_cast<std::uint32_t>(camera_.width);
    format.fmt.pix.height = static_cast<std::uint32_t>(camera_.height);
    format.fmt.pix.pixelformat = V4L2_PIX_FMT_Z16;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    RETURN_IF_ERROR(Call("VIDIOC_S_FMT", VIDIOC_S_FMT, &format));
    // The driver sets what it can instead.
    const v4l2_pix_format& got = format.fmt.pix;
    if (got.pixelformat != V4L2_PIX_FMT_Z16 ||
        got.width != static_cast<std::uint32_t>(camera_.width) ||
        got.height != static_cast<std::uint32_t>(camera_.height)) {
      return Unusable(absl::StrCat("has no depth images of ", camera_.width, " x ", camera_.height,
                                   " pixels, but e.g. of ", got.width, " x ", got.height,
                                   "; give the intrinsics of that size"));
    }
    const std::uint32_t row = std::max(got.bytesperline, 2 * got.width);
    layout_ = {.width = camera_.width, .height = camera_.height, .bytes_per_row = row};
    return absl::OkStatus();
  }

  absl::Status MapBuffers() {
    v4l2_requestbuffers request = {};
    request.count = kBufferCount;
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    RETURN_IF_ERROR(Call("VIDIOC_REQBUFS", VIDIOC_REQBUFS, &request));
    for (std::uint32_t i = 0; i < request.count; ++i) {
      v4l2_buffer buffer = BufferOf(i);
      RETURN_IF_ERROR(Call("VIDIOC_QUERYBUF", VIDIOC_QUERYBUF, &buffer));
      const void* data = video_->Map(buffer.length, buffer.m.offset);
      if (data == nullptr) {
        return absl::UnavailableError(absl::StrCat(name_, ": a buffer cannot be mapped"));
      }
      buffers_.emplace_back(static_cast<const char*>(data), buffer.length);
      RETURN_IF_ERROR(Call("VIDIOC_QBUF", VIDIOC_QBUF, &buffer));
    }
    return buffers_.empty() ? Unusable("has no buffers") : absl::OkStatus();
  }

  static v4l2_buffer BufferOf(std::uint32_t index) {
    v4l2_buffer out = {};
    out.index = index;
    out.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    out.memory = V4L2_MEMORY_MMAP;
    return out;
  }

  void Run() {
    while (!stop_) {
      if (!video_->Wait(kPollMs)) continue;
      v4l2_buffer buffer = BufferOf(0);
      const int error = video_->Control(VIDIOC_DQBUF, &buffer);
      if (error == EAGAIN) continue;
      absl::Status status =
          error == 0
              ? absl::OkStatus()
              : absl::UnavailableError(absl::StrCat(name_, " gives no images any more (",
                                                    std::strerror(error), "); was it unplugged?"));
      if (status.ok()) {
        Take(buffer);
        status = Call("VIDIOC_QBUF", VIDIOC_QBUF, &buffer);
      }
      if (status.ok()) continue;
      frames_->Fail(status);
      return;
    }
  }

  // When the image was exposed, at the latest.
  MonotonicTime TimeOf(const v4l2_buffer& buffer) const {
    const MonotonicTime now = MonotonicTime::Now();
    MonotonicTime stamp = now;
    if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) {
      const absl::Duration since_boot = absl::DurationFromTimeval(buffer.timestamp);
      const absl::Duration clock = absl::FromChrono(now.ToChrono().time_since_epoch());
      stamp = now - std::max(absl::ZeroDuration(), clock - since_boot);
    }
    return stamp - options_.latency;
  }

  void Take(const v4l2_buffer& buffer) {
    if ((buffer.flags & V4L2_BUF_FLAG_ERROR) != 0 || buffer.index >= buffers_.size()) return;
    const MonotonicTime time = TimeOf(buffer);
    const std::span<const char> mapped = buffers_[buffer.index];
    const std::span<const char> data =
        mapped.first(std::min<std::size_t>(buffer.bytesused, mapped.size()));
    const auto counts = CountsOfZ16(data, layout_);
    if (!counts.ok()) {
      NoteIncomplete(counts.status());
      return;
    }
    is_incomplete_ = false;
    SensorFrame frame = {.scan = files::DepthMessage(*counts, camera_, unit_m_)};
    SetTime(time, frame);
    frames_->Put(std::move(frame));
  }

  // Logs the first of a series.
  void NoteIncomplete(const absl::Status& why) {
    if (std::exchange(is_incomplete_, true)) return;
    spdlog::warn("event=incomplete_images camera={} error={}", LogField(name_),
                 LogField(std::string(why.message())));
  }

  const std::string path_;
  const V4l2Options options_;
  std::string name_;
  const absl::Duration silence_;
  recognition::CameraIntrinsics camera_;
  double unit_m_ = 0;
  Z16Layout layout_;
  std::unique_ptr<VideoCalls> video_;
  std::vector<std::span<const char>> buffers_;  // of video_
  std::optional<FrameMailbox> frames_;          // from the start of the stream
  bool is_incomplete_ = false;                  // of the thread
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::vector<std::uint16_t>> CountsOfZ16(std::span<const char> data,
                                                       const Z16Layout& layout) {
  if (layout.width < 1 || layout.height < 1 ||
      layout.bytes_per_row < kBytesOfPixel * static_cast<std::size_t>(layout.width)) {
    return absl::InvalidArgumentError(absl::StrCat("an image of ", layout.width, " x ",
                                                   layout.height, " pixels has rows of ",
                                                   layout.bytes_per_row, " bytes"));
  }
  const auto width = static_cast<std::size_t>(layout.width);
  const auto height = static_cast<std::size_t>(layout.height);
  const std::size_t row = kBytesOfPixel * width;
  // The last row may end with its pixels.
  if (data.size() < row || (data.size() - row) / layout.bytes_per_row < height - 1) {
    return absl::DataLossError(absl::StrCat("an image of ", width, " x ", height,
                                            " pixels came with ", data.size(), " bytes"));
  }
  std::vector<std::uint16_t> counts(width * height);
  for (std::size_t v = 0; v < height; ++v) {
    std::memcpy(counts.data() + v * width, data.data() + v * layout.bytes_per_row, row);
  }
  return counts;
}

std::optional<double> DepthUnitOfModel(const std::string& name) {
  for (const Model& model : kModels) {
    if (name.find(model.name) != std::string::npos) return model.unit_m;
  }
  return std::nullopt;
}

absl::StatusOr<std::unique_ptr<DepthSensor>> OpenV4l2(const std::string& path,
                                                      const V4l2Options& options,
                                                      const SensorSettings& settings) {
  ASSIGN_OR_RETURN(auto video, OpenVideo(path));
  return OpenV4l2(path, std::move(video), options, settings);
}

absl::StatusOr<std::unique_ptr<DepthSensor>> OpenV4l2(const std::string& path,
                                                      std::unique_ptr<VideoCalls> video,
                                                      const V4l2Options& options,
                                                      const SensorSettings& settings) {
  auto sensor = std::make_unique<V4l2Sensor>(path, std::move(video), options, settings);
  RETURN_IF_ERROR(sensor->Open());
  return sensor;
}

absl::StatusOr<std::vector<std::string>> ListV4l2() {
  namespace fs = std::filesystem;
  std::vector<std::string> devices;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator("/dev", error)) {
    const std::string path = entry.path().string();
    if (absl::StartsWith(path, "/dev/video")) devices.push_back(path);
  }
  std::ranges::sort(devices);
  std::vector<std::string> out;
  std::string trouble;
  for (const std::string& path : devices) {
    const auto video = OpenVideo(path);
    if (video.ok() && HasZ16(**video)) out.push_back(path);
    if (!video.ok()) trouble = absl::StrCat("; ", std::string(video.status().message()));
  }
  if (!out.empty()) return out;
  if (devices.empty()) {
    return absl::NotFoundError("there is no /dev/video*: no camera, or its driver is not loaded");
  }
  return absl::NotFoundError(absl::StrCat("none of ", devices.size(), " video devices, such as ",
                                          devices.front(), ", has depth images (Z16)", trouble));
}

}  // namespace graspdb::client
