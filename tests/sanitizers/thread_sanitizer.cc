// Annotations and suppressions for libraries that are built without the thread sanitizer.
//
// Absl's locks: its mutex is a futex, which the sanitizer does not intercept; without this file
// every value that an absl::Mutex guards, ours and gRPC's, would be reported as a race. Linked into
// the programs of the tsan build, the functions below take precedence over the library's own.
//
// RocksDB's group commit: one thread appends the batches of all that write at the same time. It
// uses libstdc++'s strings, and of code that is not instrumented only the frame that calls an
// interceptor is recorded: libstdc++'s, which no suppression can name without hiding our own
// strings. A function of ours records the frame that calls it. RocksDB calls those below through
// the dynamic linker, so that its frames are in the reports and "race:librocksdb" applies.
#include <dlfcn.h>
#include <rocksdb/status.h>
#include <rocksdb/write_batch.h>
#include <sanitizer/tsan_interface.h>

#include "absl/synchronization/mutex.h"

namespace {

template <typename Function>
Function* Real(const char* symbol) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, symbol));
}

}  // namespace

// The suppressions. The sanitizer requires this name.
// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" const char* __tsan_default_suppressions() {
  return "mutex:libOpenNI2\n"  // unlocks twice while it is loaded
         "mutex:libOniFile\n"  // its player of recordings, too
         "deadlock:libOpenNI2\n"
         "deadlock:libOniFile\n"
         "race:libOniFile\n"
         "race:libgrpc\n"  // hands calls over through atomics that are not instrumented
         "race:libgpr\n"
         "race:grpc::internal::Call::\n"  // its inline part, in our programs
         "race:grpc::internal::CallOpSet<\n"
         // What the other end of a channel within the process has read is freed here.
         "race:grpc::Slice::~Slice\n"
         "race:libupb\n"
         "race:libabsl_cord\n"
         "race:libabsl_graphcycles_internal\n"  // its spin lock is not instrumented
         "race:libabsl_status\n"
         "race:absl::debian3::status_internal\n"  // its inline part, in our programs
         "race:absl::debian3::Status::Unref\n"    // texts that two threads have copies of
         "race:libabsl_time_zone\n"
         "race:librocksdb\n"
         "race:libspdlog\n"  // makes its registry at the first use, in any thread
         "race:libtbb\n"
         "race:libembree3\n";
}

namespace absl {
ABSL_NAMESPACE_BEGIN

void Mutex::Lock() {
  static auto* const real = Real<void(Mutex*)>("_ZN4absl7debian35Mutex4LockEv");
  real(this);
  __tsan_acquire(this);
}

bool Mutex::TryLock() {
  static auto* const real = Real<bool(Mutex*)>("_ZN4absl7debian35Mutex7TryLockEv");
  const bool locked = real(this);
  if (locked) __tsan_acquire(this);
  return locked;
}

void Mutex::Unlock() {
  static auto* const real = Real<void(Mutex*)>("_ZN4absl7debian35Mutex6UnlockEv");
  __tsan_release(this);
  real(this);
}

void Mutex::ReaderLock() {
  static auto* const real = Real<void(Mutex*)>("_ZN4absl7debian35Mutex10ReaderLockEv");
  real(this);
  __tsan_acquire(this);
}

void Mutex::ReaderUnlock() {
  static auto* const real = Real<void(Mutex*)>("_ZN4absl7debian35Mutex12ReaderUnlockEv");
  __tsan_release(this);
  real(this);
}

bool Mutex::AwaitWithTimeout(const Condition& condition, Duration timeout) {
  static auto* const real = Real<bool(Mutex*, const Condition&, Duration)>(
      "_ZN4absl7debian35Mutex16AwaitWithTimeoutERKNS0_9ConditionENS0_8DurationE");
  __tsan_release(this);
  const bool holds = real(this, condition, timeout);
  __tsan_acquire(this);
  return holds;
}

void CondVar::Wait(Mutex* mutex) {
  static auto* const real =
      Real<void(CondVar*, Mutex*)>("_ZN4absl7debian37CondVar4WaitEPNS0_5MutexE");
  __tsan_release(mutex);
  real(this, mutex);
  __tsan_acquire(mutex);
}

bool CondVar::WaitWithTimeout(Mutex* mutex, Duration timeout) {
  static auto* const real = Real<bool(CondVar*, Mutex*, Duration)>(
      "_ZN4absl7debian37CondVar15WaitWithTimeoutEPNS0_5MutexENS0_8DurationE");
  __tsan_release(mutex);
  const bool expired = real(this, mutex, timeout);
  __tsan_acquire(mutex);
  return expired;
}

bool CondVar::WaitWithDeadline(Mutex* mutex, Time deadline) {
  static auto* const real = Real<bool(CondVar*, Mutex*, Time)>(
      "_ZN4absl7debian37CondVar16WaitWithDeadlineEPNS0_5MutexENS0_4TimeE");
  __tsan_release(mutex);
  const bool expired = real(this, mutex, deadline);
  __tsan_acquire(mutex);
  return expired;
}

ABSL_NAMESPACE_END
}  // namespace absl

namespace rocksdb {

// As in RocksDB's own header of it, which is not installed.
class WriteBatchInternal {
 public:
  static Status Append(WriteBatch* to, const WriteBatch* from, bool only_logged);
};

Status WriteBatchInternal::Append(WriteBatch* to, const WriteBatch* from, bool only_logged) {
  static auto* const real = Real<Status(WriteBatch*, const WriteBatch*, bool)>(
      "_ZN7rocksdb18WriteBatchInternal6AppendEPNS_10WriteBatchEPKS1_b");
  return real(to, from, only_logged);
}

// Of the batch that others are appended to.
void WriteBatch::Clear() {
  static auto* const real = Real<void(WriteBatch*)>("_ZN7rocksdb10WriteBatch5ClearEv");
  real(this);
}

}  // namespace rocksdb
