// What a server has acknowledged.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace graspdb::faults {

// A view by its state: taught and deleted ones are acknowledged; of a pending one a write or a
// deletion was sent and not answered.
struct KnownView {
  enum class State { kTaught, kDeleted, kPending };
  int content = 0;
  State state = State::kPending;
};

// A bulk upload.
struct KnownUpload {
  bool created = false;  // acknowledged, as are the following
  std::map<std::string, int> staged;
  std::map<std::string, int> sent;  // not answered
  bool commit_sent = false;
  bool committed = false;
};

// Thread-safe, apart from the members without a lock: for the time without traffic.
class Ledger {
 public:
  using State = KnownView::State;

  void Set(const std::string& view, int content, State state) {
    const std::scoped_lock lock(mutex_);
    views_[view] = {content, state};
    touched_.insert(view);
    if (state != State::kPending) ++acknowledged_;
  }
  // Calls `change` with the upload.
  template <typename Change>
  void ChangeUpload(const std::string& name, const Change& change, int acknowledged = 0) {
    const std::scoped_lock lock(mutex_);
    change(uploads_[name]);
    acknowledged_ += acknowledged;
  }
  void AddBackup(const std::string& name) {
    const std::scoped_lock lock(mutex_);
    backups_.push_back(name);
    ++acknowledged_;
  }
  // A taught view, by a number of the caller's choice, now pending; empty name without one.
  std::pair<std::string, int> TakeForDeletion(std::uint64_t number, std::size_t keep) {
    const std::scoped_lock lock(mutex_);
    if (views_.size() <= keep) return {};
    auto view = std::next(views_.begin(), static_cast<std::ptrdiff_t>(number % views_.size()));
    if (view->second.state != State::kTaught) return {};
    view->second.state = State::kPending;
    touched_.insert(view->first);
    return {view->first, view->second.content};
  }

  std::map<std::string, KnownView>& views() { return views_; }
  std::set<std::string>& touched() { return touched_; }  // since it was cleared
  std::map<std::string, KnownUpload>& uploads() { return uploads_; }
  std::vector<std::string>& backups() { return backups_; }
  std::int64_t acknowledged() const { return acknowledged_; }

 private:
  std::mutex mutex_;
  std::map<std::string, KnownView> views_;
  std::set<std::string> touched_;
  std::map<std::string, KnownUpload> uploads_;
  std::vector<std::string> backups_;
  std::atomic<std::int64_t> acknowledged_ = 0;
};

}  // namespace graspdb::faults
