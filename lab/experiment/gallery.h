// A catalogue in memory, taught with the server's code.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "lab/experiment/experiment_run.h"
#include "lab/experiment/trials/cases.h"
#include "recognition/models/clouds_in_memory.h"
#include "recognition/recognizer.h"

namespace graspdb::lab {

// Taught views. Teaching is not thread-safe; recognition is.
class Gallery : public recognition::CloudsInMemory {
 public:
  Gallery(std::vector<rendering::Workpiece> parts,
          const recognition::RecognitionParameters& parameters);

  // Teaches each trial as a view of its first object, in order. Errors as the trials and
  // SegmentScan, with the stable pose; INVALID_ARGUMENT when a view is 20 times as large as the
  // part's mesh, or as small, usually because of a wrong unit.
  absl::Status Teach(const TrialSource& trials, const std::string& step, const ExperimentRun& run);

  // The taught views, without view number `left_out` if given.
  recognition::CatalogueSnapshot Snapshot(std::optional<std::size_t> left_out = std::nullopt) const;

  // Whether views of the part's object were taught with its pose, so that poses can be judged.
  bool HasFrame(const rendering::Workpiece& part) const;

  // Model of the first view of a part and all views that share its frame; null if there is none.
  std::shared_ptr<const recognition::SurfaceModel> ModelOf(const rendering::Workpiece& part);

 private:
  // A view before it is added.
  struct Described {
    recognition::IndexedView view;
    recognition::OrientedCloud cloud;
  };
  absl::StatusOr<Described> Describe(const Trial& trial, std::size_t number) const;

  std::vector<rendering::Workpiece> parts_;
  std::vector<double> mesh_sizes_m_;  // diagonals of the bounding boxes, by part
  recognition::RecognitionParameters parameters_;
  std::vector<recognition::IndexedView> views_;
};

// Resource names of a workpiece and of its stable pose.
std::string ObjectName(const rendering::Workpiece& part);
std::string StablePoseName(const rendering::Workpiece& part);

// One gallery. For rendered trials of one run, in which names of meshes are unique.
class LastGallery {
 public:
  // The gallery of `teaching`; kept until another one is requested. Errors as Gallery::Teach.
  absl::StatusOr<Gallery*> Teach(const ExperimentCase& experiment, const PartSet& set,
                                 const TrialSource& teaching, const ExperimentRun& run);

 private:
  std::unique_ptr<Gallery> gallery_;
  ExperimentCase experiment_;
  std::vector<std::string> taught_;  // stable poses
};

}  // namespace graspdb::lab
