#include "server/live/filtered_snapshots.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <utility>

#include "server/live/taught_poses.h"
#include "storage/database/family.h"

namespace graspdb::server {
namespace {

// Filters whose results are kept; a cell with another one waits while its chunks are copied: 1 s
// for 100,000 views.
constexpr std::size_t kMaxFilters = 16;
// Copied views of all filters together, for each view of the catalogue. They are copied where
// hidden views are near them, 1.5 KB each.
constexpr std::size_t kMaxCopies = 2;
// A filter that is not used keeps the chunks of its last revision.
constexpr std::chrono::minutes kMaxIdle{10};

// Views that a filter does not share with the whole index.
std::size_t CopiesIn(const recognition::DescriptorIndex::FilteredChunks& chunks) {
  std::size_t out = 0;
  for (const auto& [whole, visible] : chunks) {
    if (visible != nullptr && visible != whole) out += visible->size();
  }
  return out;
}

}  // namespace

void ReleaseGates::SetObject(const std::string& name, Object object) {
  draft_objects_.erase(name);
  if (object.draft) draft_objects_.insert(name);
  if (object == Object()) {
    objects_.erase(name);
  } else {
    objects_[name] = std::move(object);
  }
}

void ReleaseGates::SetStablePose(const std::string& name, bool draft) {
  draft_poses_.erase(name);
  if (draft) draft_poses_.insert(name);
}

ReleaseGates::Object ReleaseGates::GateOf(const v1::Object& record) {
  return {record.release() == v1::RELEASE_STATE_DRAFT,
          {record.labels().begin(), record.labels().end()}};
}

void ReleaseGates::AddTo(storage::RecordVisitor* visitor, ReleaseGates* gates) {
  visitor->object = [gates](const v1::Object& object) {
    gates->SetObject(object.name(), GateOf(object));
    return absl::OkStatus();
  };
  visitor->stable_pose = [gates,
                          next = std::move(visitor->stable_pose)](const v1::StablePose& pose) {
    gates->SetStablePose(pose.name(), pose.release() == v1::RELEASE_STATE_DRAFT);
    return next ? next(pose) : absl::OkStatus();
  };
}

std::shared_ptr<const ReleaseGates> ReleaseGates::After(
    const std::shared_ptr<const ReleaseGates>& gates, const storage::ChangeRecord& change) {
  const auto concerns = [](const storage::Mutation& mutation) {
    return mutation.column_family() == storage::FamilyName(storage::Family::kObjects) ||
           mutation.column_family() == storage::FamilyName(storage::Family::kStablePoses);
  };
  if (std::ranges::none_of(change.mutations(), concerns)) return gates;
  ReleaseGates next = *gates;
  for (const storage::Mutation& mutation : change.mutations()) {
    const bool put = mutation.kind() == storage::Mutation::KIND_PUT;
    if (mutation.column_family() == storage::FamilyName(storage::Family::kObjects)) {
      v1::Object record;
      const bool unreadable = put && !record.ParseFromString(mutation.value());
      next.SetObject(mutation.key(), unreadable ? Object{.draft = true}
                                     : put      ? GateOf(record)
                                                : Object());
    } else if (mutation.column_family() == storage::FamilyName(storage::Family::kStablePoses)) {
      v1::StablePose record;
      const bool unreadable = put && !record.ParseFromString(mutation.value());
      next.SetStablePose(mutation.key(),
                         unreadable || (put && record.release() == v1::RELEASE_STATE_DRAFT));
    }
  }
  const bool same = next.objects_ == gates->objects_ && next.draft_poses_ == gates->draft_poses_;
  return same ? gates : std::make_shared<const ReleaseGates>(std::move(next));
}

bool ReleaseGates::ShowsAll(const Visibility& visibility) const {
  const bool has_drafts = !draft_objects_.empty() || !draft_poses_.empty();
  return visibility.labels.empty() && (visibility.include_drafts || !has_drafts);
}

bool ReleaseGates::Shows(const std::string& object, const std::string& stable_pose,
                         const Visibility& visibility) const {
  const auto gate = objects_.find(object);
  const bool known = gate != objects_.end();
  if (!visibility.include_drafts) {
    if ((known && gate->second.draft) || draft_poses_.contains(stable_pose)) return false;
  }
  if (visibility.labels.empty()) return true;
  return known && std::ranges::any_of(gate->second.labels, [&](const std::string& label) {
           return visibility.labels.contains(label);
         });
}

struct FilteredSnapshots::Filter {
  explicit Filter(Visibility visibility_in) : visibility(std::move(visibility_in)) {}

  const Visibility visibility;
  absl::Mutex mutex;
  std::weak_ptr<const LiveSnapshot> base ABSL_GUARDED_BY(mutex);  // of `result`
  std::shared_ptr<const ReleaseGates> gates ABSL_GUARDED_BY(mutex);
  std::shared_ptr<const recognition::CatalogueSnapshot> result ABSL_GUARDED_BY(mutex);
  recognition::DescriptorIndex::FilteredChunks chunks ABSL_GUARDED_BY(mutex);
  std::atomic<std::size_t> copy_count = 0;     // views
  std::chrono::steady_clock::time_point used;  // guarded by the mutex of the list

  std::shared_ptr<const recognition::CatalogueSnapshot> Apply(
      const std::shared_ptr<const LiveSnapshot>& next) ABSL_LOCKS_EXCLUDED(mutex);
};

std::shared_ptr<const recognition::CatalogueSnapshot> FilteredSnapshots::Filter::Apply(
    const std::shared_ptr<const LiveSnapshot>& next) {
  absl::MutexLock lock(&mutex);
  if (base.lock() == next) return result;
  if (gates != next->gates) chunks.clear();
  const auto shows = [&](const std::string& object, const std::string& pose) {
    return next->gates->Shows(object, pose, visibility);
  };
  auto poses = std::make_shared<TaughtPoses>();
  for (const auto& [name, pose] : *next->stable_poses) {
    if (shows(name.substr(0, name.find("/stablePoses/")), name)) poses->emplace(name, pose);
  }
  auto filtered = std::make_shared<recognition::CatalogueSnapshot>(recognition::CatalogueSnapshot{
      next->revision,
      next->index.Filtered(
          [&](const recognition::TaughtView& view) { return shows(view.object, view.stable_pose); },
          &chunks),
      std::move(poses)});
  copy_count = CopiesIn(chunks);
  base = next;
  gates = next->gates;
  result = std::move(filtered);
  return result;
}

std::shared_ptr<const recognition::CatalogueSnapshot> FilteredSnapshots::Get(
    const std::shared_ptr<const LiveSnapshot>& base, const Visibility& visibility) {
  std::shared_ptr<const recognition::CatalogueSnapshot> result = base;
  if (!base->gates->ShowsAll(visibility)) result = FilterOf(visibility)->Apply(base);
  Bound(base->index.view_count());
  return result;
}

std::shared_ptr<FilteredSnapshots::Filter> FilteredSnapshots::FilterOf(
    const Visibility& visibility) {
  absl::MutexLock lock(&mutex_);
  auto found = std::ranges::find(filters_, visibility, [](const auto& filter) -> const Visibility& {
    return filter->visibility;
  });
  if (found == filters_.end()) {
    found = filters_.insert(filters_.begin(), std::make_shared<Filter>(visibility));
  }
  filters_.splice(filters_.begin(), filters_, found);
  filters_.front()->used = std::chrono::steady_clock::now();
  return filters_.front();
}

void FilteredSnapshots::Bound(std::size_t base_view_count) {
  std::list<std::shared_ptr<Filter>> dropped;  // released after the lock
  absl::MutexLock lock(&mutex_);
  const auto idle_before = std::chrono::steady_clock::now() - kMaxIdle;
  std::size_t count = 0;
  std::size_t copies = 0;
  for (auto filter = filters_.begin(); filter != filters_.end(); ++filter) {
    copies += (*filter)->copy_count;
    const bool fits = ++count <= kMaxFilters && copies <= kMaxCopies * base_view_count;
    if ((count == 1 || fits) && (*filter)->used >= idle_before) continue;
    dropped.splice(dropped.begin(), filters_, filter, filters_.end());
    break;
  }
}

}  // namespace graspdb::server
