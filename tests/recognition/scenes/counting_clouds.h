// Forwards to other clouds and counts the models that are loaded.
#pragma once

#include <atomic>
#include <memory>

#include "recognition/recognizer.h"

namespace graspdb::testing {

class CountingClouds : public recognition::ViewClouds {
 public:
  explicit CountingClouds(recognition::ViewClouds& clouds) : clouds_(clouds) {}

  absl::StatusOr<std::shared_ptr<const recognition::OrientedCloud>> Load(
      const recognition::TaughtView& view) override {
    return clouds_.Load(view);
  }
  absl::StatusOr<std::shared_ptr<const recognition::SurfaceModel>> LoadModel(
      const recognition::TaughtView& view,
      const recognition::TaughtStablePose& stable_pose) override {
    ++count_;
    return clouds_.LoadModel(view, stable_pose);
  }

  int count() const { return count_; }

 private:
  recognition::ViewClouds& clouds_;
  std::atomic<int> count_ = 0;
};

}  // namespace graspdb::testing
