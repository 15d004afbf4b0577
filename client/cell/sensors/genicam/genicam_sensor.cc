#include "client/cell/sensors/genicam/genicam_sensor.h"

#include <arv.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/sensors/frame_mailbox.h"
#include "client/cell/sensors/genicam/camera_features.h"
#include "client/cell/sensors/genicam/range_image.h"
#include "program/log/log_field.h"

namespace graspdb::client {
namespace {

// Images that the library fills while one is read.
constexpr int kBufferCount = 4;
// Bytes of an image. 3D cameras have up to 5 million pixels, and send some 20 bytes for each: a
// point, its intensity and its confidence.
constexpr std::size_t kMaxImageBytes = std::size_t{128} << 20U;
// How often the reading thread looks whether it is to end, us.
constexpr std::uint64_t kPollUs = 100'000;

// Components, ComponentIDValue (SFNC 4.13).
constexpr guint kRangeComponent = 4;
constexpr guint kDisparityComponent = 8;

// In this order, unless the camera's own can be read.
constexpr const char* kPixelFormats[] = {"Coord3D_ABC32f", "Coord3D_ABC16", "Coord3D_C16",
                                         "Coord3D_C32f"};

std::vector<std::string> NamesOf(const char** names, guint count) {
  std::vector<std::string> out;
  for (guint i = 0; names != nullptr && i < count; ++i) out.emplace_back(names[i]);
  g_free(static_cast<gpointer>(names));
  return out;
}

class GenicamSensor : public DepthSensor {
 public:
  GenicamSensor(std::string id, const GenicamOptions& options, const SensorSettings& settings)
      : options_(options),
        intrinsics_(settings.intrinsics),
        name_(absl::StrCat("GenICam camera ", id)),
        id_(std::move(id)),
        silence_(settings.silence) {}

  ~GenicamSensor() override {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    if (camera_ == nullptr) return;
    if (lost_handler_ != 0) {
      g_signal_handler_disconnect(arv_camera_get_device(camera_.get()), lost_handler_);
    }
    // A camera that is gone does not answer, and the library would wait for it for seconds.
    if (stream_ != nullptr && frames_ && frames_->IsAlive()) {
      GlibError error;
      arv_camera_stop_acquisition(camera_.get(), error.out());
    }
  }
  GenicamSensor(const GenicamSensor&) = delete;
  GenicamSensor& operator=(const GenicamSensor&) = delete;

  absl::Status Open() {
    GlibError error;
    camera_.reset(arv_camera_new(id_.empty() ? nullptr : id_.c_str(), error.out()));
    if (camera_ == nullptr) {
      return absl::UnavailableError(absl::StrCat(
          name_, " cannot be opened (", error.message(),
          "); list the cameras with graspdb sensors list; is another program using it?"));
    }
    SetName();
    const CameraFeatures features(camera_.get());
    ChooseComponent();
    RETURN_IF_ERROR(ChoosePixelFormat(features));
    geometry_ = ReadRangeGeometry(features);
    RETURN_IF_ERROR(CheckBlankImage());
    return StartAcquisition(features);
  }

  absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) override {
    return frames_->Wait(MonotonicTime::Now(), deadline);
  }
  bool IsReady() override { return frames_->IsAlive(); }
  std::string Name() const override { return name_; }

 private:
  absl::Status Unusable(const std::string& what) const {
    return absl::FailedPreconditionError(absl::StrCat(name_, ": ", what));
  }

  void SetName() {
    GlibError error;
    const auto text = [](const char* value) { return std::string(value == nullptr ? "" : value); };
    const std::string vendor = text(arv_camera_get_vendor_name(camera_.get(), nullptr));
    const std::string model = text(arv_camera_get_model_name(camera_.get(), nullptr));
    const std::string serial =
        text(arv_camera_get_device_serial_number(camera_.get(), error.out()));
    name_ = absl::StrCat("GenICam camera ", vendor, " ", model, serial.empty() ? "" : " ", serial);
  }

  // Range, or else Disparity, without other components.
  void ChooseComponent() {
    guint count = 0;
    const char** names = arv_camera_dup_available_components(camera_.get(), &count, nullptr);
    const std::vector<std::string> available = NamesOf(names, count);
    for (const char* component : {"Range", "Disparity"}) {
      if (std::ranges::find(available, component) == available.end()) continue;
      GlibError error;
      arv_camera_select_and_enable_component(camera_.get(), component, TRUE, error.out());
      if (error.ok()) return;
    }
  }

  absl::Status ChoosePixelFormat(const CameraFeatures& features) {
    guint count = 0;
    const char** names =
        arv_camera_dup_available_pixel_formats_as_strings(camera_.get(), &count, nullptr);
    const std::vector<std::string> available = NamesOf(names, count);
    std::vector<std::string> wanted(std::begin(kPixelFormats), std::end(kPixelFormats));
    if (!options_.pixel_format.empty()) {
      wanted = {options_.pixel_format};
    } else if (CurrentFormat()) {
      return absl::OkStatus();
    }
    for (const std::string& format : wanted) {
      if (std::ranges::find(available, format) == available.end()) continue;
      if (features.Set("PixelFormat", format.c_str()) && CurrentFormat()) return absl::OkStatus();
    }
    const std::string current = features.Text("PixelFormat").value_or("none");
    std::string all;
    for (const std::string& format : available) absl::StrAppend(&all, " ", format);
    return Unusable(
        absl::StrCat("its PixelFormat is ", current, " of", all.empty() ? " none" : all,
                     "; Coord3D_ABC32f, Coord3D_ABC16, Coord3D_C16 and Coord3D_C32f can be read"));
  }

  std::optional<RangeFormat> CurrentFormat() const {
    GlibError error;
    const ArvPixelFormat format = arv_camera_get_pixel_format(camera_.get(), error.out());
    return error.ok() ? RangeFormatOf(format) : std::nullopt;
  }

  // What cannot be used is reported when the camera is opened, instead of with each image.
  absl::Status CheckBlankImage() {
    GlibError error;
    gint x = 0;
    gint y = 0;
    gint width = 0;
    gint height = 0;
    arv_camera_get_region(camera_.get(), &x, &y, &width, &height, error.out());
    const guint payload = error.ok() ? arv_camera_get_payload(camera_.get(), error.out()) : 0;
    if (!error.ok() || width <= 0 || height <= 0 || payload == 0 || payload > kMaxImageBytes) {
      return Unusable(absl::StrCat("it has no usable image size: ", width, " x ", height,
                                   " pixels, ", payload, " bytes ", error.message()));
    }
    payload_ = payload;
    // Of the camera's options without a size.
    if (intrinsics_ && intrinsics_->width == 0) intrinsics_->width = width;
    if (intrinsics_ && intrinsics_->height == 0) intrinsics_->height = height;
    const std::optional<RangeFormat> format = CurrentFormat();
    if (!format) return absl::UnavailableError(absl::StrCat(name_, " does not answer any more"));
    const int bits = static_cast<int>((static_cast<std::uint32_t>(*format) >> 16U) & 0xFFU);
    const std::size_t bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                              static_cast<std::size_t>(bits / 8);
    if (bytes > payload_) {
      return Unusable(absl::StrCat("its PayloadSize of ", payload, " bytes has no room for ", width,
                                   " x ", height, " pixels"));
    }
    const std::vector<char> blank(bytes);
    const absl::Status usable =
        ScanOfRange({.format = *format, .width = width, .height = height, .data = blank}, geometry_,
                    intrinsics_)
            .status();
    return usable.ok() ? usable : Unusable(std::string(usable.message()));
  }

  absl::Status StartAcquisition(const CameraFeatures& features) {
    features.Set("AcquisitionMode", "Continuous");
    if (arv_camera_is_gv_device(camera_.get()) != FALSE) {
      GlibError error;
      arv_camera_gv_auto_packet_size(camera_.get(), error.out());  // else that of the camera
    }
    GlibError error;
    stream_.reset(arv_camera_create_stream(camera_.get(), nullptr, nullptr, error.out()));
    if (stream_ != nullptr) {
      for (int i = 0; i < kBufferCount; ++i) {
        arv_stream_push_buffer(stream_.get(), arv_buffer_new(payload_, nullptr));
      }
      arv_camera_start_acquisition(camera_.get(), error.out());
    }
    if (stream_ == nullptr || !error.ok()) {
      return absl::UnavailableError(
          absl::StrCat(name_, " does not start (", error.message(), "); try again"));
    }
    frames_.emplace(silence_);
    lost_handler_ = g_signal_connect(arv_camera_get_device(camera_.get()), "control-lost",
                                     G_CALLBACK(&GenicamSensor::OnLost), this);
    thread_ = std::thread([this] { Run(); });
    return absl::OkStatus();
  }

  static void OnLost(ArvDevice* /*device*/, gpointer self) {
    auto* sensor = static_cast<GenicamSensor*>(self);
    sensor->frames_->Fail(absl::UnavailableError(
        absl::StrCat(sensor->name_, " was disconnected, or another program controls it")));
  }

  void Run() {
    while (!stop_) {
      ArvBuffer* buffer = arv_stream_timeout_pop_buffer(stream_.get(), kPollUs);
      if (buffer == nullptr) continue;
      const MonotonicTime arrival = MonotonicTime::Now();
      if (arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS) {
        Take(buffer, arrival - options_.latency);
      } else {
        NoteIncomplete();
      }
      arv_stream_push_buffer(stream_.get(), buffer);
    }
  }

  // Logs the first of a series.
  void NoteIncomplete() {
    if (is_incomplete_) return;
    is_incomplete_ = true;
    spdlog::warn(
        "event=incomplete_images camera={} advice=\"is the network fast enough, and the "
        "packet size (MTU) that of all its parts?\"",
        LogField(name_));
  }

  void Take(ArvBuffer* buffer, MonotonicTime time) {
    const std::optional<guint> part = RangePart(buffer);
    if (!part) return;  // e.g. an intensity image
    gint x_padding = 0;
    gint y_padding = 0;
    arv_buffer_get_part_padding(buffer, *part, &x_padding, &y_padding);
    std::size_t size = 0;
    const auto* data = static_cast<const char*>(arv_buffer_get_part_data(buffer, *part, &size));
    RangeImage image;
    image.format = *RangeFormatOf(arv_buffer_get_part_pixel_format(buffer, *part));
    image.width = arv_buffer_get_part_width(buffer, *part);
    image.height = arv_buffer_get_part_height(buffer, *part);
    image.data = std::span<const char>(data, data == nullptr ? 0 : size);
    absl::StatusOr<files::ScanMessage> scan =
        x_padding == 0 ? ScanOfRange(image, geometry_, intrinsics_)
                       : absl::StatusOr<files::ScanMessage>(Unusable("its rows are padded"));
    if (!scan.ok()) {
      // It was changed after it was opened; opening it again reads its features again.
      frames_->Fail(absl::UnavailableError(
          absl::StrCat(name_, " sends other images: ", std::string(scan.status().message()))));
      return;
    }
    is_incomplete_ = false;
    SensorFrame frame = {.scan = *std::move(scan)};
    SetTime(time, frame);
    frames_->Put(std::move(frame));
  }

  // Of an image or a multipart buffer: the component Range, else Disparity, else any in a format
  // that can be read.
  static std::optional<guint> RangePart(ArvBuffer* buffer) {
    std::optional<guint> found;
    int best = -1;
    const guint count = arv_buffer_get_n_parts(buffer);
    for (guint i = 0; i < count; ++i) {
      if (!RangeFormatOf(arv_buffer_get_part_pixel_format(buffer, i))) continue;
      const guint component = arv_buffer_get_part_component_id(buffer, i);
      const int rank = component == kRangeComponent ? 2 : component == kDisparityComponent ? 1 : 0;
      if (rank <= best) continue;
      best = rank;
      found = i;
    }
    return found;
  }

  const GenicamOptions options_;
  std::optional<recognition::CameraIntrinsics> intrinsics_;
  std::string name_;
  const std::string id_;
  std::size_t payload_ = 0;
  RangeGeometry geometry_;
  const absl::Duration silence_;
  std::optional<FrameMailbox> frames_;  // from the start of the acquisition
  ObjectPtr<ArvCamera> camera_;
  ObjectPtr<ArvStream> stream_;  // ends before the camera
  gulong lost_handler_ = 0;
  bool is_incomplete_ = false;  // of the thread
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<DepthSensor>> OpenGenicam(const std::string& id,
                                                         const GenicamOptions& options,
                                                         const SensorSettings& settings) {
  auto sensor = std::make_unique<GenicamSensor>(id, options, settings);
  RETURN_IF_ERROR(sensor->Open());
  return sensor;
}

absl::StatusOr<std::vector<std::string>> ListGenicam() {
  arv_update_device_list();
  std::vector<std::string> out;
  for (unsigned int i = 0; i < arv_get_n_devices(); ++i) {
    const char* id = arv_get_device_id(i);
    if (id != nullptr) out.emplace_back(id);
  }
  return out;
}

}  // namespace graspdb::client
