#include "client/archive/archive_comparison.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"

namespace graspdb::client {
namespace {

// m, and parts of a unit quaternion. Rounding changes 1e-16.
constexpr double kPoseTolerance = 1e-9;

bool IsNear(const v1::Pose& a, const v1::Pose& b) {
  const v1::Vector3& p = a.position();
  const v1::Vector3& q = b.position();
  const v1::Quaternion& r = a.orientation();
  const v1::Quaternion& s = b.orientation();
  const double cosine = r.x() * s.x() + r.y() * s.y() + r.z() * s.z() + r.w() * s.w();
  const double sign = cosine < 0 ? -1 : 1;  // both are the same rotation
  const std::array<double, 7> apart = {
      p.x() - q.x(),        p.y() - q.y(),        p.z() - q.z(),       r.x() - sign * s.x(),
      r.y() - sign * s.y(), r.z() - sign * s.z(), r.w() - sign * s.w()};
  // False for NaN.
  return std::ranges::all_of(apart, [](double d) { return std::abs(d) <= kPoseTolerance; });
}

absl::Time ToTime(const google::protobuf::Timestamp& time) {
  return absl::FromUnixSeconds(time.seconds()) + absl::Nanoseconds(time.nanos());
}

// When its content was last changed: of a view, when it was taught.
absl::Time ChangeTimeOf(const v1::Object& object) { return ToTime(object.update_time()); }
absl::Time ChangeTimeOf(const v1::StablePose& pose) { return ToTime(pose.update_time()); }
absl::Time ChangeTimeOf(const v1::View& view) { return ToTime(view.create_time()); }

// Records without a release state are released.
template <typename Record>
void SetReleased(Record& record) {
  if (record.release() == v1::RELEASE_STATE_UNSPECIFIED) {
    record.set_release(v1::RELEASE_STATE_RELEASED);
  }
}

const v1::Object& RecordOf(const v1::ArchiveRecord& record, const v1::Object* /*kind*/) {
  return record.object();
}
const v1::StablePose& RecordOf(const v1::ArchiveRecord& record, const v1::StablePose* /*kind*/) {
  return record.stable_pose();
}
const v1::View& RecordOf(const v1::ArchiveRecord& record, const v1::View* /*kind*/) {
  return record.view();
}

std::string EtagOf(const v1::Object& object) { return object.etag(); }
std::string EtagOf(const v1::StablePose& pose) { return pose.etag(); }
std::string EtagOf(const v1::View& /*view*/) { return ""; }

template <typename Record>
LaterChange LaterOf(const Record& file, const Record& server) {
  const absl::Time of_file = ChangeTimeOf(file);
  const absl::Time of_server = ChangeTimeOf(server);
  if (of_file == of_server) return LaterChange::kUnknown;
  return of_file > of_server ? LaterChange::kFile : LaterChange::kServer;
}

ArchiveAction ActionOf(ArchiveState state, LaterChange later, OnConflict on_conflict) {
  switch (state) {
    case ArchiveState::kSame:
      return ArchiveAction::kNothing;
    case ArchiveState::kNew:
      return ArchiveAction::kCreate;
    case ArchiveState::kNewer:
      return ArchiveAction::kReplace;
    case ArchiveState::kOlder:
      return ArchiveAction::kKeep;
    case ArchiveState::kConflict:
      break;
  }
  if (on_conflict == OnConflict::kFail) return ArchiveAction::kUndecided;
  const bool replaces = on_conflict == OnConflict::kReplace ||
                        (on_conflict == OnConflict::kLater && later == LaterChange::kFile);
  return replaces ? ArchiveAction::kReplace : ArchiveAction::kKeep;
}

// Records by their names.
template <typename Record>
std::map<std::string, Record> ByName(std::vector<Record> records) {
  std::map<std::string, Record> out;
  for (Record& record : records) {
    std::string name = record.name();
    out.emplace(std::move(name), std::move(record));
  }
  return out;
}

class Comparer {
 public:
  Comparer(Client& client, const OpenArchive& archive, const ComparisonOptions& options,
           const ComparisonWatch& watch)
      : client_(client),
        archive_(archive),
        options_(options),
        watch_(watch),
        missing_(options.objects.begin(), options.objects.end()),
        wanted_(missing_) {
    if (options.base == nullptr) return;
    for (const files::ArchiveEntry& entry : options.base->index.entries) {
      base_.emplace(entry.name, entry.offset);
    }
  }

  absl::StatusOr<ArchiveComparison> Run() {
    const std::vector<files::ArchiveEntry>& entries = archive_.index.entries;
    out_.actions.assign(entries.size(), ArchiveAction::kSkip);
    for (entry_ = 0; entry_ < entries.size(); ++entry_) {
      if (watch_.cancelled && watch_.cancelled()) {
        return absl::CancelledError("interrupted; nothing was changed");
      }
      RETURN_IF_ERROR(Compare(entries[entry_]));
      if (watch_.report) watch_.report(entry_ + 1);
    }
    EndStablePose();
    if (!missing_.empty()) {
      return absl::NotFoundError(absl::StrCat(archive_.file.path().string(), " has no ",
                                              *missing_.begin(),
                                              "; leave out --object to import all"));
    }
    return std::move(out_);
  }

 private:
  absl::Status Compare(const files::ArchiveEntry& entry) {
    if (entry.kind != files::ArchiveKind::kView) EndStablePose();
    if (entry.kind == files::ArchiveKind::kObject) {
      missing_.erase(entry.name);
      is_wanted_ = wanted_.empty() || wanted_.contains(entry.name);
    }
    if (!is_wanted_) return absl::OkStatus();
    switch (entry.kind) {
      case files::ArchiveKind::kObject:
        return CompareObject(entry);
      case files::ArchiveKind::kStablePose:
        return CompareStablePose(entry);
      case files::ArchiveKind::kView:
        return CompareView(entry);
    }
    return absl::OkStatus();
  }

  absl::Status CompareObject(const files::ArchiveEntry& entry) {
    poses_.clear();
    const absl::StatusOr<v1::Object> server = client_.GetObject(entry.name);
    if (absl::IsNotFound(server.status())) return Note(entry, ArchiveState::kNew);
    if (!server.ok()) return server.status();
    absl::StatusOr<std::vector<v1::StablePose>> poses = client_.ListStablePoses(entry.name);
    if (!poses.ok() && !absl::IsNotFound(poses.status())) return poses.status();
    if (poses.ok()) poses_ = ByName(*std::move(poses));
    return Judge(entry, *server);
  }

  absl::Status CompareStablePose(const files::ArchiveEntry& entry) {
    const auto server = poses_.find(entry.name);
    if (server == poses_.end()) return Note(entry, ArchiveState::kNew);
    absl::StatusOr<std::vector<v1::View>> views = client_.ListViews(entry.name);
    if (!views.ok() && !absl::IsNotFound(views.status())) return views.status();
    if (views.ok()) views_ = ByName(*std::move(views));
    stable_pose_ = entry.name;
    return Judge(entry, server->second);
  }

  void EndStablePose() {
    const bool stays = stays_ || matched_view_count_ < views_.size();
    if (takes_ && stays) out_.joined_stable_poses.push_back(stable_pose_);
    takes_ = false;
    stays_ = false;
    matched_view_count_ = 0;
    conflict_.reset();
    views_.clear();
  }

  absl::Status CompareView(const files::ArchiveEntry& entry) {
    const auto listed = views_.find(entry.name);
    if (listed == views_.end()) return Note(entry, ArchiveState::kNew);
    ++matched_view_count_;
    ASSIGN_OR_RETURN(const files::ArchiveItem item, archive_.file.ReadAt(entry.offset));
    // The cloud is needed only where it decides.
    if (!MayBeSame(item.record.view(), listed->second) && base_.empty()) {
      return JudgeBy(entry, item.record.view(), listed->second);
    }
    const absl::StatusOr<v1::View> server = client_.GetView(entry.name);
    if (absl::IsNotFound(server.status())) return Note(entry, ArchiveState::kNew);
    if (!server.ok()) return server.status();
    return JudgeBy(entry, item.record.view(), *server);
  }

  template <typename Record>
  absl::Status Judge(const files::ArchiveEntry& entry, const Record& server) {
    ASSIGN_OR_RETURN(const files::ArchiveItem item, archive_.file.ReadAt(entry.offset));
    return JudgeBy(entry, RecordOf(item.record, &server), server);
  }

  template <typename Record>
  absl::Status JudgeBy(const files::ArchiveEntry& entry, const Record& file, const Record& server) {
    if (IsSame(file, server)) return Note(entry, ArchiveState::kSame);
    ArchiveState state = ArchiveState::kConflict;
    if (const auto found = base_.find(entry.name); found != base_.end()) {
      ASSIGN_OR_RETURN(const files::ArchiveItem item, options_.base->file.ReadAt(found->second));
      const Record& base = RecordOf(item.record, &server);
      if (IsSame(base, file)) state = ArchiveState::kOlder;
      if (IsSame(base, server)) state = ArchiveState::kNewer;
    }
    return Note(entry, state, LaterOf(file, server), EtagOf(server));
  }

  absl::Status Note(const files::ArchiveEntry& entry, ArchiveState state,
                    LaterChange later = LaterChange::kUnknown, std::string etag = "") {
    ArchiveAction action = ActionOf(state, later, options_.on_conflict);
    const bool is_view = entry.kind == files::ArchiveKind::kView;
    if (is_view && conflict_) action = BesideConflict(state, action);
    if (entry.kind == files::ArchiveKind::kStablePose && state == ArchiveState::kConflict) {
      conflict_ = action;
    }
    if (entry.kind != files::ArchiveKind::kObject) {
      takes_ |= action == ArchiveAction::kCreate || action == ArchiveAction::kReplace;
      stays_ |= action == ArchiveAction::kKeep;
    }
    out_.left_out_count += action == ArchiveAction::kLeaveOut ? 1 : 0;
    out_.actions[entry_] = action;
    ++out_.counts[static_cast<std::size_t>(entry.kind)][static_cast<std::size_t>(state)];
    if (state != ArchiveState::kSame && state != ArchiveState::kNew) {
      out_.differences.push_back({entry_, state, action, later, std::move(etag)});
    }
    return absl::OkStatus();
  }

  // A view of a stable pose in conflict: the object's frame, in which its grasps are, may be
  // another one in the file than on the server, so that the views come from where the stable pose
  // does.
  ArchiveAction BesideConflict(ArchiveState state, ArchiveAction action) const {
    const bool takes = action == ArchiveAction::kCreate || action == ArchiveAction::kReplace;
    if (*conflict_ == ArchiveAction::kUndecided && takes) return ArchiveAction::kUndecided;
    if (*conflict_ == ArchiveAction::kKeep && takes) {
      return action == ArchiveAction::kCreate ? ArchiveAction::kLeaveOut : ArchiveAction::kKeep;
    }
    return state == ArchiveState::kConflict ? *conflict_ : action;
  }

  Client& client_;
  const OpenArchive& archive_;
  const ComparisonOptions& options_;
  const ComparisonWatch& watch_;
  std::set<std::string> missing_;  // wanted objects that the file has not had so far
  const std::set<std::string> wanted_;
  std::map<std::string, std::int64_t> base_;  // offsets of the base's records

  std::size_t entry_ = 0;
  bool is_wanted_ = true;
  std::map<std::string, v1::StablePose> poses_;  // of the server, of the last object
  // Of the last stable pose:
  std::string stable_pose_;                // if the server has it
  std::map<std::string, v1::View> views_;  // of the server
  std::optional<ArchiveAction> conflict_;  // of the stable pose itself, if it is one
  bool takes_ = false;                     // it, or a view, from the file
  bool stays_ = false;  // it, or a view, as on the server, which the file has otherwise
  std::size_t matched_view_count_ = 0;  // views that both have, the same or not
  ArchiveComparison out_;
};

}  // namespace

v1::Object ContentOf(v1::Object object) {
  object.clear_name();
  object.clear_create_time();
  object.clear_update_time();
  object.clear_delete_time();
  object.clear_purge_time();
  object.clear_etag();
  SetReleased(object);
  return object;
}

v1::StablePose ContentOf(v1::StablePose pose) {
  pose.clear_name();
  pose.clear_create_time();
  pose.clear_update_time();
  pose.clear_etag();
  pose.clear_grasp_outcomes();
  SetReleased(pose);
  return pose;
}

bool IsSame(const v1::Object& a, const v1::Object& b) {
  return ContentOf(a).SerializeAsString() == ContentOf(b).SerializeAsString();
}

bool IsSame(const v1::StablePose& a, const v1::StablePose& b) {
  return ContentOf(a).SerializeAsString() == ContentOf(b).SerializeAsString();
}

bool MayBeSame(const v1::View& a, const v1::View& b) {
  return a.point_count() == b.point_count() &&
         a.object_pose_estimated() == b.object_pose_estimated() &&
         IsNear(a.object_pose(), b.object_pose()) && IsNear(a.sensor_pose(), b.sensor_pose());
}

bool IsSame(const v1::View& a, const v1::View& b) {
  return MayBeSame(a, b) && a.cloud().data() == b.cloud().data();
}

std::string_view NameOf(ArchiveState state) {
  constexpr std::array<std::string_view, kArchiveStates> kNames = {"same", "new", "newer", "older",
                                                                   "conflict"};
  return kNames[static_cast<std::size_t>(state)];
}

std::string_view NameOf(ArchiveAction action) {
  constexpr std::array<std::string_view, 7> kNames = {"skip", "nothing",   "create",   "replace",
                                                      "keep", "leave out", "undecided"};
  return kNames[static_cast<std::size_t>(action)];
}

std::int64_t ArchiveComparison::CountOf(ArchiveState state) const {
  std::int64_t out = 0;
  for (const auto& of_kind : counts) out += of_kind[static_cast<std::size_t>(state)];
  return out;
}

absl::StatusOr<ArchiveComparison> CompareArchive(Client& client, const OpenArchive& archive,
                                                 const ComparisonOptions& options,
                                                 const ComparisonWatch& watch) {
  return Comparer(client, archive, options, watch).Run();
}

}  // namespace graspdb::client
