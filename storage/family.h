// The column families of the database.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace graspdb::storage {

enum class Family {
  kMeta,
  kObjects,
  kStablePoses,
  kViews,
  kClouds,
  kCells,
  kChanges,
  kGraspOutcomes,
  kUploads,
  kStagedViews,
  kHistory,
  kDeletedObjects
};

inline constexpr std::size_t kFamilyCount = 12;

// Names on disk, in the order of the enumerators. They never change their meaning.
inline constexpr std::array<std::string_view, kFamilyCount> kFamilyNames = {
    "default", "objects",        "stable_poses", "views",        "clouds",  "cells",
    "changes", "grasp_outcomes", "uploads",      "staged_views", "history", "deleted_objects"};

constexpr std::string_view FamilyName(Family family) {
  return kFamilyNames[static_cast<std::size_t>(family)];
}

}  // namespace graspdb::storage
