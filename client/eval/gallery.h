// A catalogue in memory, taught with the code that the server teaches with.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "absl/status/status.h"
#include "client/eval/trial.h"
#include "recognition/recognizer.h"

namespace graspdb::client {

// Views that were taught. Teaching is not thread-safe; asking is.
class Gallery : public recognition::ViewClouds {
 public:
  Gallery(const std::vector<Workpiece>& parts,
          const recognition::RecognitionParameters& parameters);

  // Teaches what a trial shows, as a view of its first object.
  absl::Status Teach(const Trial& trial);

  recognition::CatalogueSnapshot Snapshot() const;

  absl::StatusOr<std::shared_ptr<const recognition::OrientedCloud>> Load(
      const recognition::TaughtView& view) override;
  absl::StatusOr<std::shared_ptr<const recognition::SurfaceModel>> LoadModel(
      const recognition::TaughtView& view,
      const recognition::TaughtStablePose& stable_pose) override;

  const std::vector<recognition::IndexedView>& views() const { return views_; }

 private:
  const std::vector<Workpiece>* parts_;
  recognition::RecognitionParameters parameters_;
  std::vector<recognition::IndexedView> views_;
  std::unordered_map<std::string, std::shared_ptr<const recognition::OrientedCloud>> clouds_;
  std::unordered_map<std::string, std::vector<recognition::PosedCloud>> posed_;  // by stable pose
  std::mutex mutex_;                                                             // guards models_
  std::unordered_map<std::string, std::shared_ptr<const recognition::SurfaceModel>> models_;
};

// Resource names of a workpiece and of its stable pose.
std::string ObjectName(const Workpiece& part);
std::string StablePoseName(const Workpiece& part);

}  // namespace graspdb::client
