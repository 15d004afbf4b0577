// The column families of the database, and the keys of its changes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
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

// Keys of the family `changes`: the revision, big-endian, so that RocksDB's order of
// bytes is the order of revisions.
inline std::string ChangeKey(std::int64_t revision) {
  std::string key(sizeof(revision), '\0');
  auto rest = static_cast<std::uint64_t>(revision);
  for (std::size_t i = key.size(); i-- > 0; rest >>= 8) key[i] = static_cast<char>(rest & 0xff);
  return key;
}

}  // namespace graspdb::storage
