#include "recognition/base/idle_cores.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <list>
#include <mutex>
#include <thread>
#include <utility>

namespace graspdb::recognition {
namespace {

// Jobs that any thread may start, in order.
struct Batch {
  const std::function<void(std::size_t)>& job;
  std::size_t count;
  std::size_t begun = 0;
  std::size_t at_work = 0;  // threads
  std::exception_ptr failure = nullptr;
};

// Of this thread: a job that calls ForEachIndex keeps one core busy, not two.
thread_local bool is_at_work = false;

// Threads that wait for batches; they live as long as the process.
class Helpers {
 public:
  Helpers() : cores_(std::max(1U, std::thread::hardware_concurrency())) {
    for (std::size_t i = 1; i < cores_; ++i) std::thread([this] { Help(); }).detach();
  }

  void Run(Batch& batch) {
    std::unique_lock lock(mutex_);
    const auto at = batches_.insert(batches_.end(), &batch);
    changed_.notify_all();
    Work(batch, lock);
    batches_.erase(at);
    changed_.wait(lock, [&] { return batch.at_work == 0; });
  }

 private:
  void Help() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return at_work_ < cores_ && Open() != nullptr; });
      Work(*Open(), lock);
    }
  }

  Batch* Open() const {
    const auto open =
        std::ranges::find_if(batches_, [](const Batch* b) { return b->begun < b->count; });
    return open == batches_.end() ? nullptr : *open;
  }

  // Runs the remaining jobs of a batch.
  void Work(Batch& batch, std::unique_lock<std::mutex>& lock) {
    const bool was_at_work = std::exchange(is_at_work, true);
    at_work_ += !was_at_work;
    ++batch.at_work;
    while (batch.begun < batch.count) {
      const std::size_t i = batch.begun++;
      lock.unlock();
      std::exception_ptr failure = Try(batch.job, i);
      lock.lock();
      if (failure && !batch.failure) batch.failure = std::move(failure);
    }
    --batch.at_work;
    at_work_ -= !was_at_work;
    is_at_work = was_at_work;
    changed_.notify_all();
  }

  static std::exception_ptr Try(const std::function<void(std::size_t)>& job, std::size_t i) {
    try {
      job(i);
    } catch (...) {
      return std::current_exception();
    }
    return nullptr;
  }

  const std::size_t cores_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::list<Batch*> batches_;
  std::size_t at_work_ = 0;  // threads
};

}  // namespace

void ForEachIndex(std::size_t count, const std::function<void(std::size_t)>& job) {
  if (count == 0) return;
  if (count == 1) return job(0);
  // Never destroyed: its threads may still wait when the process ends.
  static Helpers& helpers = *new Helpers();
  Batch batch{.job = job, .count = count};
  helpers.Run(batch);
  if (batch.failure) std::rethrow_exception(batch.failure);
}

}  // namespace graspdb::recognition
