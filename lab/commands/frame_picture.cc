#include "lab/commands/frame_picture.h"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "absl/strings/str_format.h"
#include "recognition/verification/visibility.h"

namespace graspdb::lab {
namespace {

using Eigen::Vector3f;

// Pixels: fewer than the cameras have, so that every row and column has a measurement.
constexpr int kWidth = 480;
constexpr int kMaxHeight = 480;
// This share of the tangents is cut off at either end, as stray points.
constexpr double kStrayShare = 0.002;
// Stride of the points of a model that are drawn: the scan shows between them.
constexpr std::size_t kDrawnStride = 2;
// Grey of the farthest and of the nearest point.
constexpr float kFarGrey = 30;
constexpr float kNearGrey = 230;
// Grey levels per mm of approach between neighbouring pixels.
constexpr float kGreyPerMm = 6;

bool IsInFront(const Vector3f& p) { return p.allFinite() && p.z() > 0; }

// The values at a share of `kStrayShare` from either end; both 0 without values.
std::pair<float, float> RangeOf(std::vector<float> values) {
  if (values.empty()) return {0, 0};
  std::ranges::sort(values);
  const auto cut = static_cast<std::size_t>(kStrayShare * static_cast<double>(values.size()));
  return {values[cut], values[values.size() - 1 - cut]};
}

// A pinhole camera whose image the scan fills.
class Image {
 public:
  explicit Image(const recognition::Points& scan) {
    std::vector<float> across;
    std::vector<float> down;
    std::vector<float> depths;
    for (const Vector3f& p : scan) {
      if (!IsInFront(p)) continue;
      across.push_back(p.x() / p.z());
      down.push_back(p.y() / p.z());
      depths.push_back(p.z());
    }
    const auto [left, right] = RangeOf(std::move(across));
    const auto [top, bottom] = RangeOf(std::move(down));
    std::tie(nearest_, farthest_) = RangeOf(std::move(depths));
    left_ = left;
    top_ = top;
    pixels_ = static_cast<float>(kWidth - 1) / std::max(right - left, 1e-6F);
    height_ = std::clamp(static_cast<int>((bottom - top) * pixels_) + 1, 1, kMaxHeight);
    depth_.resize(static_cast<std::size_t>(kWidth) * static_cast<std::size_t>(height_));
    for (const Vector3f& p : scan) {
      const auto at = PixelOf(p);
      if (!at) continue;
      float& here = depth_[*at];
      if (here == 0 || p.z() < here) here = p.z();
    }
  }

  std::optional<std::size_t> PixelOf(const Vector3f& p) const {
    if (!IsInFront(p)) return std::nullopt;
    const float x = (p.x() / p.z() - left_) * pixels_;
    const float y = (p.y() / p.z() - top_) * pixels_;
    const bool inside =
        x >= 0 && y >= 0 && x < static_cast<float>(kWidth) && y < static_cast<float>(height_);
    if (!inside) return std::nullopt;
    return static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x);
  }

  std::vector<std::uint8_t> Brightness() const {
    std::vector<std::uint8_t> out(depth_.size());
    const float range = std::max(farthest_ - nearest_, 1e-6F);
    for (std::size_t i = 0; i < depth_.size(); ++i) {
      if (depth_[i] == 0) continue;
      const float far = std::clamp((depth_[i] - nearest_) / range, 0.0F, 1.0F);
      const bool has_left = i % kWidth > 0 && depth_[i - 1] > 0;
      const float slope = has_left ? 1000 * (depth_[i - 1] - depth_[i]) : 0;
      const float grey = kNearGrey + far * (kFarGrey - kNearGrey) + kGreyPerMm * slope;
      out[i] = static_cast<std::uint8_t>(std::clamp(grey, kFarGrey, 255.0F));
    }
    return out;
  }

  int height() const { return height_; }

 private:
  float left_ = 0;
  float top_ = 0;
  float pixels_ = 1;  // of a tangent of 1
  float nearest_ = 0;
  float farthest_ = 0;
  int height_ = 1;
  std::vector<float> depth_;  // m; 0: nothing
};

std::uint32_t ColorOf(PosedModel::Verdict verdict) {
  switch (verdict) {
    case PosedModel::Verdict::kRight:
      return 0x30d060;
    case PosedModel::Verdict::kWrong:
      return 0xff4040;
    case PosedModel::Verdict::kLost:
      return 0xffd020;
  }
  return 0;
}

}  // namespace

pictures::ShadedPicture DrawFrame(const FrameResult& result, const recognition::Points& scan) {
  const Image image(scan);
  pictures::ShadedPicture out{.caption = absl::StrFormat("%s  %.0f ms  %s", result.frame->name,
                                                         result.milliseconds, result.error),
                              .width = kWidth,
                              .height = image.height(),
                              .brightness = image.Brightness()};
  for (const PosedModel& posed : result.posed) {
    const recognition::VisibleSurface visible(posed.model->fine, posed.sensor_object.cast<float>());
    for (std::size_t k = 0; k < visible.points().size(); k += kDrawnStride) {
      const auto at = image.PixelOf(visible.At(visible.points()[k]));
      if (at) out.marks.push_back({*at, ColorOf(posed.verdict)});
    }
  }
  return out;
}

}  // namespace graspdb::lab
