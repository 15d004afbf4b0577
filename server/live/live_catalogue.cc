#include "server/live/live_catalogue.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "base/status_macros.h"
#include "program/log/log_field.h"
#include "server/base/background.h"
#include "server/live/change_effects.h"
#include "server/live/load_views.h"
#include "server/live/records.h"
#include "storage/database/family.h"

namespace graspdb::server {
namespace {

// Whether this very view, not only one of its name.
bool IsStillTaught(const TaughtPoses& poses,
                   const std::shared_ptr<const recognition::TaughtView>& view) {
  const auto pose = poses.find(PoseOfView(view->name));
  return pose != poses.end() &&
         std::ranges::find(pose->second->views, view) != pose->second->views.end();
}

}  // namespace

LiveCatalogue::LiveCatalogue(storage::Catalogue& catalogue,
                             const recognition::DescriptorParameters& parameters)
    : catalogue_(catalogue), parameters_(parameters) {}

LiveCatalogue::~LiveCatalogue() {
  // Fails only inside the listener; nothing to do then.
  (void)catalogue_.Subscribe({});
}

absl::StatusOr<std::unique_ptr<LiveCatalogue>> LiveCatalogue::Follow(
    storage::Catalogue& catalogue, const recognition::DescriptorParameters& parameters,
    const recognition::IsCancelled& is_cancelled) {
  std::unique_ptr<LiveCatalogue> out(new LiveCatalogue(catalogue, parameters));
  RETURN_IF_ERROR(out->Load(is_cancelled));
  ASSIGN_OR_RETURN(std::int64_t from,
                   catalogue.Subscribe([live = out.get()](const storage::ChangeRecord& change) {
                     live->Apply(change);
                   }));
  if (from != out->snapshot()->revision) {
    return absl::InternalError("the catalogue changed while it was loaded");
  }
  return out;
}

absl::Status LiveCatalogue::Load(const recognition::IsCancelled& is_cancelled) {
  const auto reload = [this] {
    absl::MutexLock lock(&change_mutex_);
    return Reload();
  };
  const absl::StatusOr<std::vector<std::string>> undescribed = reload();
  if (!undescribed.ok() || undescribed->empty()) return undescribed.status();
  RETURN_IF_ERROR(Redescribe(catalogue_, *undescribed, parameters_, is_cancelled));
  return reload().status();
}

absl::StatusOr<std::vector<std::string>> LiveCatalogue::Reload() {
  TaughtPoseChange poses;
  std::vector<std::string> left_out;
  std::vector<std::string> undescribed;
  storage::RecordVisitor others = StablePoseVisitor(&poses, &left_out);
  ReleaseGates gates;
  ReleaseGates::AddTo(&others, &gates);
  ASSIGN_OR_RETURN(LoadedViews loaded,
                   ReadViews(catalogue_, parameters_, std::move(others), &undescribed));
  poses.added_views = std::move(loaded.views);
  std::set<std::string> all_left_out(left_out.begin(), left_out.end());
  all_left_out.insert(loaded.left_out.begin(), loaded.left_out.end());
  all_left_out.insert(undescribed.begin(), undescribed.end());
  Publish({{loaded.revision, std::move(loaded.index),
            std::make_shared<const TaughtPoses>(Changed({}, poses))},
           std::make_shared<const ReleaseGates>(std::move(gates))});
  SetLeftOut(std::move(all_left_out));
  return undescribed;
}

void LiveCatalogue::Apply(const storage::ChangeRecord& change) {
  absl::MutexLock lock(&change_mutex_);
  const std::shared_ptr<const Snapshot> current = snapshot();
  if (change.revision() <= current->revision) return;  // read with another one already
  const bool in_order = !stale_ && change.revision() == current->revision + 1;
  // Until it is published. However this function ends, the next call notices.
  stale_ = true;
  const absl::Status advanced = Guarded([&]() -> absl::Status {
    if (!in_order) return absl::FailedPreconditionError("a previous change is missing");
    Advance(*current, change);
    return absl::OkStatus();
  });
  if (advanced.ok()) {
    stale_ = false;
    return;
  }
  spdlog::error("event=change_not_applied revision={} error={}", change.revision(),
                LogField(std::string(advanced.message())));
  Recover();
}

void LiveCatalogue::Advance(const Snapshot& current, const storage::ChangeRecord& change) {
  Snapshot next = current;
  next.revision = change.revision();
  const Effects effects = EffectsOf(change, *next.stable_poses, parameters_);
  if (!effects.removed.empty()) next.index = next.index.Without(effects.removed);
  if (!effects.added.empty()) next.index = next.index.With(effects.added);
  next.stable_poses =
      std::make_shared<const TaughtPoses>(Changed(*next.stable_poses, effects.poses));
  next.gates = ReleaseGates::After(next.gates, change);
  std::set<std::string> left_out = left_out_;
  for (const std::string& name : effects.touched) left_out.erase(name);
  left_out.insert(effects.left_out.begin(), effects.left_out.end());
  Publish(std::move(next));
  SetLeftOut(std::move(left_out));
}

void LiveCatalogue::LeaveOutDamaged(const std::string& view) {
  const auto poses = snapshot()->stable_poses;
  const auto pose = poses->find(PoseOfView(view));
  if (pose == poses->end()) return;
  DamagedViews damaged;
  for (const auto& taught : pose->second->views) {
    absl::Status read = catalogue_.GetPackedCloud(taught->name).status();
    if (absl::IsDataLoss(read)) damaged.emplace(taught, std::move(read));
  }
  if (damaged.size() == pose->second->views.size() &&
      std::ranges::none_of(catalogue_.damaged_files(), &storage::DamagedFile::is_lost)) {
    return;
  }
  LeaveOut(damaged);
}

// As if they were deleted. A view that was taught again meanwhile has another cloud, and stays.
void LiveCatalogue::LeaveOut(const DamagedViews& damaged) {
  absl::MutexLock lock(&change_mutex_);
  if (stale_) return;
  const std::shared_ptr<const Snapshot> current = snapshot();
  storage::ChangeRecord deletions;
  for (const auto& [view, why] : damaged) {
    if (!IsStillTaught(*current->stable_poses, view)) continue;
    LogLeftOut(view->name, why);
    storage::Mutation& deletion = *deletions.add_mutations();
    deletion.set_kind(storage::Mutation::KIND_DELETE);
    deletion.set_column_family(std::string(storage::FamilyName(storage::Family::kViews)));
    deletion.set_key(view->name);
  }
  if (deletions.mutations().empty()) return;
  deletions.set_revision(current->revision);
  std::set<std::string> left_out = left_out_;
  for (const storage::Mutation& deletion : deletions.mutations()) left_out.insert(deletion.key());
  Advance(*current, deletions);
  SetLeftOut(std::move(left_out));
}

void LiveCatalogue::SetLeftOut(std::set<std::string> names) {
  left_out_ = std::move(names);
  left_out_count_ = std::ssize(left_out_);
}

void LiveCatalogue::SetAgrees(bool agrees) {
  agrees_ = agrees;
  if (report_) report_(agrees);
}

void LiveCatalogue::ReportAgreement(std::function<void(bool)> report) {
  absl::MutexLock lock(&change_mutex_);
  report_ = std::move(report);
  if (report_) report_(agrees_);
}

void LiveCatalogue::Recover() {
  SetAgrees(false);
  const absl::Status reloaded = Guarded([&] { return Reload().status(); });
  if (reloaded.ok()) {
    stale_ = false;
    SetAgrees(true);
    spdlog::info("event=catalogue_reloaded revision={}", snapshot()->revision);
  } else {
    spdlog::error("event=catalogue_behind revision={} error={}", snapshot()->revision,
                  LogField(std::string(reloaded.message())));
  }
}

void LiveCatalogue::CatchUp() {
  absl::MutexLock lock(&change_mutex_);
  if (stale_) Recover();
}

void LiveCatalogue::Publish(Snapshot snapshot) {
  auto next = std::make_shared<const Snapshot>(std::move(snapshot));
  const std::scoped_lock publishing(publishing_);
  published_.notify_all();  // who wakes up waits for the lock
  absl::MutexLock lock(&mutex_);
  snapshot_.swap(next);  // the old one is released after the locks
}

void LiveCatalogue::AwaitRevisionAfter(std::int64_t revision, std::chrono::nanoseconds time) const {
  std::unique_lock lock(publishing_);
  published_.wait_for(lock, time, [&] { return snapshot()->revision > revision; });
}

std::shared_ptr<const LiveSnapshot> LiveCatalogue::snapshot() const {
  absl::MutexLock lock(&mutex_);
  return snapshot_;
}

}  // namespace graspdb::server
