// Look-alikes in a catalogue, for the teacher to check before operation.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/models/shape_similarity.h"
#include "recognition/recognizer.h"

namespace graspdb::recognition {

struct StablePoseSymmetry {
  std::string stable_pose;  // resource name
  int declared_order = 1;
  FoundSymmetry found;
};

struct LookAlikes {
  std::string stable_pose;  // resource names
  std::string other;
  ShapeSimilarity similarity;  // T_other_stablePose
  bool nearly = false;
};

struct CatalogueSimilarity {
  std::vector<StablePoseSymmetry> symmetries;  // by name; found or declared
  std::vector<LookAlikes> pairs;               // by name; each pair once
};

// Compares all stable poses whose views specify the object's pose (TaughtView::shares_frame): pairs
// of them where one is of `object` (resource name; empty: all). Errors of `clouds`; CANCELLED.
absl::StatusOr<CatalogueSimilarity> FindLookAlikes(const CatalogueSnapshot& catalogue,
                                                   ViewClouds& clouds, const std::string& object,
                                                   const IsCancelled& is_cancelled);

}  // namespace graspdb::recognition
