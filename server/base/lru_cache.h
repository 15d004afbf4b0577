// A least recently used cache with a memory budget.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"

namespace graspdb::server {

// Statistics of a cache since its construction.
struct CacheUse {
  std::int64_t hits = 0;
  std::int64_t misses = 0;
  std::int64_t rejected = 0;  // values that were too large for the cache
  std::size_t bytes = 0;
  std::size_t byte_budget = 0;
};

// Values by key; the least recently used ones are evicted when their bytes exceed the budget. The
// cost of a call does not depend on the number of values, except of evicted ones.
// Thread-safe.
template <typename Value>
class LruCache {
 public:
  explicit LruCache(std::size_t byte_budget) : use_{.byte_budget = byte_budget} {}

  // Null if missing; counts a hit or a miss.
  std::shared_ptr<const Value> Get(const std::string& key) {
    absl::MutexLock lock(&mutex_);
    const auto found = by_key_.find(key);
    if (found == by_key_.end()) {
      ++use_.misses;
      return nullptr;
    }
    ++use_.hits;
    entries_.splice(entries_.begin(), entries_, found->second);
    return found->second->value;
  }

  // Counts nothing, and does not count as a use.
  bool Contains(const std::string& key) const {
    absl::MutexLock lock(&mutex_);
    return by_key_.contains(key);
  }

  // Does nothing if the key exists. A value of more than half the budget is not cached: it would
  // evict most of the others, and be evicted by the next one of its size. With a larger share, a
  // single value could evict all others.
  void Put(const std::string& key, std::shared_ptr<const Value> value, std::size_t bytes) {
    bytes += 2 * key.size();
    absl::MutexLock lock(&mutex_);
    if (by_key_.contains(key)) return;
    if (bytes > use_.byte_budget / 2) {
      ++use_.rejected;
      return;
    }
    entries_.push_front({key, std::move(value), bytes});
    by_key_.emplace(key, entries_.begin());
    use_.bytes += bytes;
    while (use_.bytes > use_.byte_budget && !entries_.empty()) {
      use_.bytes -= entries_.back().bytes;
      by_key_.erase(entries_.back().key);
      entries_.pop_back();
    }
  }

  CacheUse use() const {
    absl::MutexLock lock(&mutex_);
    return use_;
  }

 private:
  struct Entry {
    std::string key;
    std::shared_ptr<const Value> value;
    std::size_t bytes;
  };

  mutable absl::Mutex mutex_;
  CacheUse use_ ABSL_GUARDED_BY(mutex_);
  std::list<Entry> entries_ ABSL_GUARDED_BY(mutex_);  // the most recently used in front
  std::unordered_map<std::string, typename std::list<Entry>::iterator> by_key_
      ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::server
