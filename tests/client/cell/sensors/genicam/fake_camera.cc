#include "tests/client/cell/sensors/genicam/fake_camera.h"

#include <arv.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <iterator>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/sensors/genicam/camera_features.h"
#include "files/messages/scan_message.h"

namespace graspdb::client {
namespace {

constexpr const char* kModes[] = {"UncalibratedC", "CalibratedC", "CalibratedABC_Grid",
                                  "DisparityC"};
constexpr guint32 kFramePeriodUs = 20'000;

}  // namespace

struct FakeGenicamCamera::Parts {
  static void Fill(ArvBuffer* buffer, void* self, guint32 /*exposure*/, guint32 /*gain*/,
                   ArvPixelFormat format) {
    auto* parts = static_cast<Parts*>(self);
    // Nothing of the buffer counts as received yet; it has room for an image.
    auto* data = static_cast<char*>(const_cast<void*>(arv_buffer_get_data(buffer, nullptr)));
    const auto size = static_cast<std::size_t>(arv_buffer_get_image_width(buffer)) *
                      static_cast<std::size_t>(arv_buffer_get_image_height(buffer)) *
                      ARV_PIXEL_FORMAT_BIT_PER_PIXEL(format) / 8;
    const absl::MutexLock lock(&parts->mutex);
    std::ranges::copy_n(parts->bytes.begin(),
                        static_cast<std::ptrdiff_t>(std::min(size, parts->bytes.size())), data);
  }

  ArvFakeCamera* camera() { return arv_gv_fake_camera_get_fake_camera(gige.get()); }

  void Write(guint32 address, double value) {
    auto bits = std::bit_cast<std::uint64_t>(value);
    bits = GUINT64_TO_BE(bits);
    arv_fake_camera_write_memory(camera(), address, sizeof(bits), &bits);
  }

  void SetFormat(guint32 format, int width, int height) {
    arv_fake_camera_write_register(camera(), ARV_FAKE_CAMERA_REGISTER_WIDTH,
                                   static_cast<guint32>(width));
    arv_fake_camera_write_register(camera(), ARV_FAKE_CAMERA_REGISTER_HEIGHT,
                                   static_cast<guint32>(height));
    arv_fake_camera_write_register(camera(), ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT, format);
  }

  absl::Mutex mutex;
  std::string bytes ABSL_GUARDED_BY(mutex);
  ObjectPtr<ArvGvFakeCamera> gige;
};

FakeGenicamCamera::FakeGenicamCamera() : parts_(std::make_unique<Parts>()) {
  parts_->gige.reset(arv_gv_fake_camera_new_full("127.0.0.1", "GD01", GRASPDB_RANGE_CAMERA_XML));
  arv_fake_camera_write_register(
      parts_->camera(), ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US, kFramePeriodUs);
  arv_fake_camera_set_fill_pattern(parts_->camera(), &Parts::Fill, parts_.get());
}

FakeGenicamCamera::~FakeGenicamCamera() = default;

bool FakeGenicamCamera::IsRunning() const {
  return arv_gv_fake_camera_is_running(parts_->gige.get()) != FALSE;
}

void FakeGenicamCamera::Describe(const RangeGeometry& geometry) {
  const auto mode = std::ranges::find_if(
      kModes, [&geometry](const char* name) { return geometry.output_mode == name; });
  arv_fake_camera_write_register(parts_->camera(), 0x400,
                                 static_cast<guint32>(std::distance(std::begin(kModes), mode)));
  arv_fake_camera_write_register(parts_->camera(), 0x404,
                                 geometry.coordinate_system == "Spherical" ? 1 : 0);
  arv_fake_camera_write_register(parts_->camera(), 0x408, geometry.distance_unit == "Inch" ? 1 : 0);
  arv_fake_camera_write_register(parts_->camera(), 0x40c, geometry.axes[2].invalid ? 1 : 0);
  for (std::size_t i = 0; i < geometry.axes.size(); ++i) {
    const auto at = static_cast<guint32>(8 * i);
    parts_->Write(0x420 + at, geometry.axes[i].scale.value_or(1));
    parts_->Write(0x440 + at, geometry.axes[i].offset);
  }
  parts_->Write(0x460, geometry.axes[2].invalid.value_or(0));
  parts_->Write(0x468, geometry.focal_length);
  parts_->Write(0x470, geometry.aspect_ratio);
  parts_->Write(0x478, geometry.principal_u);
  parts_->Write(0x480, geometry.principal_v);
  parts_->Write(0x488, geometry.baseline_m);
}

void FakeGenicamCamera::Show(RangeFormat format, int width, int height, std::string bytes) {
  {
    const absl::MutexLock lock(&parts_->mutex);
    parts_->bytes = std::move(bytes);
  }
  parts_->SetFormat(static_cast<guint32>(format), width, height);
}

void FakeGenicamCamera::Show(const v1::DepthImage& image) {
  RangeGeometry geometry;
  geometry.output_mode = "CalibratedC";
  geometry.axes[2].scale = files::DepthUnit(image) * 1000;
  geometry.axes[2].invalid = 0;
  geometry.focal_length = image.intrinsics().fx();
  geometry.aspect_ratio = image.intrinsics().fy() / image.intrinsics().fx();
  geometry.principal_u = image.intrinsics().cx();
  geometry.principal_v = image.intrinsics().cy();
  Describe(geometry);
  Show(RangeFormat::kC16, image.intrinsics().width(), image.intrinsics().height(), image.data());
}

void FakeGenicamCamera::ShowMono8() { parts_->SetFormat(ARV_PIXEL_FORMAT_MONO_8, 8, 4); }

}  // namespace graspdb::client
