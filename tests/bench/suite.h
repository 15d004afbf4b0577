// What is measured, and how it is named.
#pragma once

#include <benchmark/benchmark.h>
#include <valgrind/callgrind.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace graspdb::bench {

// Measures `work` as `who` does it. Everybody's times of one work are compared with "graspdb"'s.
inline void Compare(const std::string& work, const std::string& who,
                    std::function<void(benchmark::State&)> run) {
  benchmark::RegisterBenchmark((work + " | " + who).c_str(), std::move(run))
      ->Unit(benchmark::kMillisecond);
}

// While it lives, callgrind counts, when it runs the benchmarks without --collect-atstart.
class Counted {
 public:
  Counted() { CALLGRIND_TOGGLE_COLLECT; }
  ~Counted() { CALLGRIND_TOGGLE_COLLECT; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
};

// What is expensive to make, made when it is first asked for: a run with a filter makes only what
// it needs. For one thread.
template <typename T>
class Lazy {
 public:
  explicit Lazy(std::function<T()> make) : state_(std::make_shared<State>(std::move(make))) {}
  const T& operator*() const {
    if (!state_->value) state_->value.emplace(state_->make());
    return *state_->value;
  }
  const T* operator->() const { return &**this; }

 private:
  struct State {
    explicit State(std::function<T()> how) : make(std::move(how)) {}
    std::function<T()> make;
    std::optional<T> value;
  };
  std::shared_ptr<State> state_;
};

void AddSegmentation();
void AddFusion();
void AddRegistration();
void AddIndex();
void AddWhole();

}  // namespace graspdb::bench
