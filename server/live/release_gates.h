// Which objects and stable poses a request meets.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// What the cell of a request admits.
struct Visibility {
  bool include_drafts = false;
  std::set<std::string> labels = {};  // objects with one of these; empty: all objects
  bool operator==(const Visibility&) const = default;
};

// Release states and labels of all objects and stable poses. Immutable.
class ReleaseGates {
 public:
  // Of all records that `add_to` visits; it outlives the visitor.
  static void AddTo(storage::RecordVisitor* visitor, ReleaseGates* gates);

  // `gates` after a change: the same pointer if the change concerns none of them. An unreadable
  // record is a draft.
  static std::shared_ptr<const ReleaseGates> After(const std::shared_ptr<const ReleaseGates>& gates,
                                                   const storage::ChangeRecord& change);

  bool ShowsAll(const Visibility& visibility) const;
  // The names are of an object and one of its stable poses.
  bool Shows(const std::string& object, const std::string& stable_pose,
             const Visibility& visibility) const;

 private:
  struct Object {
    bool draft = false;
    std::vector<std::string> labels = {};
    bool operator==(const Object&) const = default;
  };

  void SetObject(const std::string& name, Object object);
  void SetStablePose(const std::string& name, bool draft);
  static Object GateOf(const v1::Object& record);

  std::map<std::string, Object> objects_;  // drafts, and those with labels
  std::set<std::string> draft_objects_;
  std::set<std::string> draft_poses_;
};

}  // namespace graspdb::server
