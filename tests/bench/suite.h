// The benchmarks and their names.
#pragma once

#include <benchmark/benchmark.h>
#include <valgrind/callgrind.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace graspdb::bench {

// Measures `work` by `program`. Times of the same work are compared to those of "graspdb".
inline void Compare(const std::string& work, const std::string& program,
                    std::function<void(benchmark::State&)> run) {
  benchmark::RegisterBenchmark((work + " | " + program).c_str(), std::move(run))
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

// An expensive value that is made on first use, so that a run with a filter makes only the values
// that it needs. Not thread-safe.
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
