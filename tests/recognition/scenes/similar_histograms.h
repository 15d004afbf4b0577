// Descriptors that are as near to each other as those of real views.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "absl/strings/str_format.h"
#include "recognition/index/descriptor_chunk.h"
#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::testing {

using recognition::Descriptor;
using recognition::IndexedView;

inline constexpr int kBins = 288;

inline Descriptor Scaled(Descriptor bins) {
  double sum = 0;
  for (const float bin : bins) sum += bin;
  for (float& bin : bins) bin = sum > 0 ? static_cast<float>(bin / sum) : 0.0F;
  return bins;
}

// Histograms of a few shapes that pass into each other, as views of parts do.
class Shapes {
 public:
  explicit Shapes(Random& random) : random_(random) {
    for (Descriptor& shape : shapes_) {
      for (float& bin : shape) bin = static_cast<float>(std::max(0.0, Uniform(random_, -1, 1)));
    }
  }

  Descriptor Next() {
    const auto& a = shapes_[random_() % shapes_.size()];
    const auto& b = shapes_[random_() % shapes_.size()];
    const double share = Uniform(random_, 0, 1);
    Descriptor out(kBins);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const double noise = 1 + Uniform(random_, -0.2, 0.2);
      out[i] = static_cast<float>((share * a[i] + (1 - share) * b[i]) * noise);
    }
    return Scaled(out);
  }

 private:
  Random& random_;
  std::vector<Descriptor> shapes_ = std::vector<Descriptor>(6, Descriptor(kBins));
};

// Named in an order that is not that of the descriptors.
inline std::vector<IndexedView> ViewsOf(const std::vector<Descriptor>& descriptors) {
  std::vector<IndexedView> out;
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    auto view = std::make_shared<recognition::TaughtView>();
    view->name = absl::StrFormat("%05d", i * 7919 % 10007);
    out.push_back({std::move(view), descriptors[i]});
  }
  return out;
}

}  // namespace graspdb::testing
