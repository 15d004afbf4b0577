#include "server/calls/call_places.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"

namespace graspdb::server {
namespace {

// Of a kind's places one caller gets one in so many.
constexpr int kCallerShare = 2;

// One in so many is for callers with an identity.
constexpr int kIdentifiedShare = 4;

// Streams of server reflection.
constexpr int kReflectionStreams = 8;

using PlaceClock = std::chrono::steady_clock;

}  // namespace

CallPlaces::Place::~Place() {
  if (places_ != nullptr) places_->Remove(kind_, entry_);
}

void CallPlaces::Place::NoteUse() {
  absl::MutexLock lock(&places_->mutex_);
  entry_->last_use = PlaceClock::now();
}

void CallPlaces::Place::NoteEnd() {
  absl::MutexLock lock(&places_->mutex_);
  entry_->context = nullptr;
}

bool CallPlaces::Place::is_cancelled() const {
  absl::MutexLock lock(&places_->mutex_);
  return entry_->is_cancelled;
}

CallPlaces::CallPlaces(const Limits& limits) : idle_(limits.idle) {
  unary_.limit = limits.unary;
  streams_.limit = limits.streams;
  reflection_.limit = kReflectionStreams;
}

const CallPlaces::Group& CallPlaces::GroupOf(Kind kind) const {
  if (kind == Kind::kUnary) return unary_;
  return kind == Kind::kStream ? streams_ : reflection_;
}

CallPlaces::Group& CallPlaces::GroupOf(Kind kind) {
  return const_cast<Group&>(std::as_const(*this).GroupOf(kind));
}

CallPlaces::Place CallPlaces::Add(Kind kind, Caller caller, grpc::ServerContextBase* context) {
  Group& group = GroupOf(kind);
  ++group.by_caller[caller.name];
  if (!caller.is_identified) ++group.anonymous;
  group.entries.push_back({std::move(caller), context, PlaceClock::now()});
  return {this, kind, std::prev(group.entries.end())};
}

void CallPlaces::Remove(Kind kind, Entries::iterator entry) {
  absl::MutexLock lock(&mutex_);
  Group& group = GroupOf(kind);
  const auto caller = group.by_caller.find(entry->caller.name);
  if (--caller->second == 0) group.by_caller.erase(caller);
  if (!entry->caller.is_identified) --group.anonymous;
  group.entries.erase(entry);
}

namespace {

// Cancels the stream of `entries` that is idle for the longest time, longer than `idle`, and that
// `matches`. Once: its end may take a moment.
template <typename Entries, typename Matches>
void CancelLongestIdle(Entries& entries, std::chrono::milliseconds idle, const Matches& matches) {
  auto longest = entries.end();
  for (auto it = entries.begin(); it != entries.end(); ++it) {
    if (it->context == nullptr || !matches(it->caller)) continue;
    if (longest == entries.end() || it->last_use < longest->last_use) longest = it;
  }
  if (longest == entries.end() || PlaceClock::now() - longest->last_use < idle) return;
  longest->is_cancelled = true;
  std::exchange(longest->context, nullptr)->TryCancel();
}

}  // namespace

absl::StatusOr<CallPlaces::Place> CallPlaces::Take(Kind kind, Caller caller,
                                                   grpc::ServerContextBase* context) {
  absl::MutexLock lock(&mutex_);
  Group& group = GroupOf(kind);
  const auto own = group.by_caller.find(caller.name);
  const bool is_over_own =
      own != group.by_caller.end() && own->second >= group.limit / kCallerShare;
  const bool is_over_anonymous =
      !caller.is_identified && group.anonymous >= group.limit - group.limit / kIdentifiedShare;
  const bool is_full = static_cast<int>(group.entries.size()) >= group.limit;
  if (!is_over_own && !is_over_anonymous && !is_full) {
    return Add(kind, std::move(caller), context);
  }
  CancelLongestIdle(group.entries, idle_, [&](const Caller& other) {
    if (is_over_own) return other.name == caller.name;
    return is_full || !other.is_identified;
  });
  const std::string whose = is_over_own         ? absl::StrCat("of ", caller.name)
                            : is_over_anonymous ? "of callers without identity"
                                                : "of all callers";
  const absl::Status full = absl::ResourceExhaustedError(absl::StrCat(
      "the server has no place for another ", kind == Kind::kStream ? "stream " : "call ", whose,
      "; end one that is not needed, or try again a little later"));
  return TryAgainLater(kind == Kind::kStream ? WithReason(full, "STREAMS_FULL")
                                             : WithReason(full, "CALLS_FULL"));
}

CallPlaces::Place CallPlaces::TakeForReflection(grpc::ServerContextBase& context) {
  absl::MutexLock lock(&mutex_);
  if (static_cast<int>(reflection_.entries.size()) >= reflection_.limit) {
    CancelLongestIdle(reflection_.entries, std::chrono::milliseconds(0),
                      [](const Caller& /*other*/) { return true; });
  }
  return Add(Kind::kReflection, {}, &context);
}

int CallPlaces::used(Kind kind) const {
  absl::MutexLock lock(&mutex_);
  return static_cast<int>(GroupOf(kind).entries.size());
}

int CallPlaces::limit(Kind kind) const {
  absl::MutexLock lock(&mutex_);
  return GroupOf(kind).limit;
}

}  // namespace graspdb::server
