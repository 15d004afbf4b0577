// A catalogue of thousands of views for the benchmarks.
#pragma once

#include <memory>
#include <vector>

#include "recognition/models/clouds_in_memory.h"
#include "recognition/recognizer.h"

namespace graspdb::bench {

// One view in the types of both programs.
struct TaughtCloud {
  std::shared_ptr<const recognition::TaughtView> view;
  std::shared_ptr<const recognition::OrientedCloud> cloud;  // world frame of its capture
  recognition::Descriptor descriptor;
};

// Sample parts captured by a simulated Kinect v2 from all around, and variants of them scaled along
// their axes, up to `view_count` views. The same on every run.
class Catalogue : public recognition::CloudsInMemory {
 public:
  explicit Catalogue(std::size_t view_count);

  const recognition::CatalogueSnapshot& snapshot() const { return snapshot_; }
  const std::vector<TaughtCloud>& views() const { return views_; }

 private:
  std::vector<TaughtCloud> views_;
  recognition::CatalogueSnapshot snapshot_{
      .revision = 1,
      .index = recognition::DescriptorIndex(
          recognition::DescriptorSize(recognition::DescriptorKind::kGsh288)),
      .stable_poses = nullptr};
};

}  // namespace graspdb::bench
