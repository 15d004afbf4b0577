// Compares an archive with a server's catalogue, and decides what an import does.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/sdk/client.h"
#include "files/archives/archive_index.h"
#include "graspdb/v1/catalog.pb.h"

namespace graspdb::client {

// The content of a record is what two servers have to agree in to have the same.

// Without the fields that a server sets: name, times, etag, counts of outcomes.
v1::Object ContentOf(v1::Object object);
v1::StablePose ContentOf(v1::StablePose pose);

bool IsSame(const v1::Object& a, const v1::Object& b);
bool IsSame(const v1::StablePose& a, const v1::StablePose& b);
// Poses may differ by rounding (1e-9): earlier servers normalise them with each upload. Both with
// their clouds.
bool IsSame(const v1::View& a, const v1::View& b);
// Of all but the clouds; false without the need to read them.
bool MayBeSame(const v1::View& a, const v1::View& b);

// A record of the file, compared with that of the same name on the server.
enum class ArchiveState : std::uint8_t {
  kSame,
  kNew,       // the server has none
  kNewer,     // differs, and the server has what the base has: only the file was changed
  kOlder,     // differs, and the file has what the base has: only the server was changed
  kConflict,  // differs, and both may have been changed
};
inline constexpr std::size_t kArchiveStates = 5;
// "same", "new", …
std::string_view NameOf(ArchiveState state);

enum class ArchiveAction : std::uint8_t {
  kSkip,     // of an object that is not imported
  kNothing,  // the same
  kCreate,
  kReplace,
  kKeep,      // the server's record stays
  kLeaveOut,  // not on the server, and stays out: a view of a conflicting stable pose that is kept
  // With OnConflict::kFail: a conflict, or a view of a stable pose in conflict that differs or is
  // new. An import should write nothing.
  kUndecided,
};
std::string_view NameOf(ArchiveAction action);

// What to do with kConflict.
enum class OnConflict : std::uint8_t {
  kFail,
  kKeep,
  kReplace,
  kLater,  // the one whose content was changed later, by the two servers' clocks
};

enum class LaterChange : std::uint8_t { kUnknown, kFile, kServer };

// A record that the server has with other content.
struct ArchiveDifference {
  std::size_t entry = 0;  // of ArchiveIndex::entries
  ArchiveState state = ArchiveState::kConflict;
  ArchiveAction action = ArchiveAction::kKeep;
  LaterChange later = LaterChange::kUnknown;
  std::string etag = {};  // of the server's object or stable pose
};

struct ArchiveComparison {
  std::vector<ArchiveAction> actions;  // one for each of ArchiveIndex::entries
  // By ArchiveKind and ArchiveState.
  std::array<std::array<std::int64_t, kArchiveStates>, 3> counts{};
  std::vector<ArchiveDifference> differences;  // kNewer, kOlder and kConflict, in the file's order
  std::int64_t left_out_count = 0;
  // Stable poses that get grasps or views of the file beside some of the server's own, which the
  // file does not have or has otherwise: right only if all were taught in one frame of the object.
  std::vector<std::string> joined_stable_poses;

  std::int64_t CountOf(ArchiveState state) const;
};

// An archive with its index; both outlive their users.
struct OpenArchive {
  const files::ArchiveFile& file;
  const files::ArchiveIndex& index;
};

struct ComparisonOptions {
  OnConflict on_conflict = OnConflict::kFail;
  std::vector<std::string> objects = {};  // resource names; empty: all of the file
  // A file of the state from which both sides began; may be null.
  const OpenArchive* base = nullptr;
};

// Both callbacks are optional.
struct ComparisonWatch {
  std::function<void(std::size_t done)> report = nullptr;  // records of the file
  std::function<bool()> cancelled = nullptr;
};

// Only reads. Clouds are compared where the other fields agree. NOT_FOUND for an object that the
// file does not have; CANCELLED; DATA_LOSS of the file; errors of the server.
absl::StatusOr<ArchiveComparison> CompareArchive(Client& client, const OpenArchive& archive,
                                                 const ComparisonOptions& options,
                                                 const ComparisonWatch& watch);

}  // namespace graspdb::client
