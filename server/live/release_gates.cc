#include "server/live/release_gates.h"

#include <algorithm>
#include <utility>

#include "storage/database/family.h"

namespace graspdb::server {

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

}  // namespace graspdb::server
