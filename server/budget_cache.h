// What was used lately, as much of it as a budget of memory allows.
#pragma once

#include <list>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"

namespace graspdb::server {

// Values by key; the least recently used ones leave when their bytes exceed the budget.
// Thread-safe.
template <typename Value>
class BudgetCache {
 public:
  explicit BudgetCache(std::size_t byte_budget) : byte_budget_(byte_budget) {}

  // Null when it is not there.
  std::shared_ptr<const Value> Get(const std::string& key) {
    absl::MutexLock lock(&mutex_);
    const auto found = by_key_.find(key);
    if (found == by_key_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, found->second);
    return found->second->value;
  }

  // Does nothing when another thread was faster.
  void Put(const std::string& key, std::shared_ptr<const Value> value, std::size_t bytes) {
    bytes += 2 * key.size();
    absl::MutexLock lock(&mutex_);
    if (by_key_.contains(key)) return;
    entries_.push_front({key, std::move(value), bytes});
    by_key_.emplace(key, entries_.begin());
    bytes_ += bytes;
    while (bytes_ > byte_budget_ && !entries_.empty()) {
      bytes_ -= entries_.back().bytes;
      by_key_.erase(entries_.back().key);
      entries_.pop_back();
    }
  }

  std::size_t bytes() const {
    absl::MutexLock lock(&mutex_);
    return bytes_;
  }

 private:
  struct Entry {
    std::string key;
    std::shared_ptr<const Value> value;
    std::size_t bytes;
  };

  const std::size_t byte_budget_;
  mutable absl::Mutex mutex_;
  std::list<Entry> entries_ ABSL_GUARDED_BY(mutex_);  // the most recently used in front
  std::unordered_map<std::string, typename std::list<Entry>::iterator> by_key_
      ABSL_GUARDED_BY(mutex_);
  std::size_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace graspdb::server
