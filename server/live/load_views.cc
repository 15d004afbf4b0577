#include "server/live/load_views.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/log/log_field.h"
#include "server/live/change_effects.h"
#include "server/live/records.h"
#include "storage/uploads/uploads.h"

namespace graspdb::server {
namespace {

// The index has chunks of 512; a multiple leaves none of them partly filled.
constexpr std::size_t kPortion = 2048;

constexpr std::size_t kRedescribeBatch = 256;

// A view that cannot be described with these parameters.
absl::Status CannotDescribe(const std::string& name, const absl::Status& status) {
  return {status.code(),
          absl::StrCat(name, " cannot be described with these parameters: ", status.message(),
                       "; start with the --voxel-size and --normal-radius that it was taught with, "
                       "or delete it with them first")};
}

// DATA_LOSS if the record or cloud cannot be used; other errors if it cannot be described.
absl::StatusOr<storage::DescriptorRecord> DescribeAgain(
    const storage::NewView& stored, const recognition::DescriptorParameters& parameters) {
  ASSIGN_OR_RETURN(const auto view, ViewFromRecord(stored.record));
  const recognition::Pose& sensor = view->world_sensor;
  const absl::StatusOr<recognition::OrientedCloud> cloud =
      CloudFromPacked(stored.packed_cloud, sensor, parameters);
  if (!cloud.ok()) return absl::DataLossError(cloud.status().message());
  return MakeDescriptorRecord(*cloud, sensor, parameters);
}

// What becomes of a view that cannot be described.
enum class Undescribable { kIsAnError, kIsLeftOut };

// Where the views are that are described again.
struct ViewStore {
  std::function<absl::StatusOr<storage::NewView>(const std::string& name)> get;
  std::function<absl::Status(std::span<const storage::DescriptorUpdate> updates)> replace;
  std::string_view when_cancelled;  // the text of CANCELLED
};

ViewStore StoreOf(storage::Catalogue& catalogue) {
  return {.get = [&catalogue](const std::string& name) -> absl::StatusOr<storage::NewView> {
            ASSIGN_OR_RETURN(storage::ViewRecord record, catalogue.GetView(name));
            ASSIGN_OR_RETURN(std::string packed, catalogue.GetPackedCloud(name));
            return storage::NewView{std::move(record), std::move(packed)};
          },
          .replace =
              [&catalogue](std::span<const storage::DescriptorUpdate> updates) {
                return catalogue.ReplaceDescriptors(updates).status();
              },
          .when_cancelled = "stopped; the next start describes the other views"};
}

ViewStore StoreOf(storage::Uploads& uploads, const storage::UploadRecord& upload) {
  return {.get = [&](const std::string& name) { return uploads.GetStaged(upload, name); },
          .replace =
              [&](std::span<const storage::DescriptorUpdate> updates) {
                return uploads.ReplaceDescriptors(upload, updates);
              },
          .when_cancelled = kCommitCancelled};
}

absl::Status RedescribeAll(const ViewStore& views, const std::vector<std::string>& names,
                           const recognition::DescriptorParameters& parameters,
                           Undescribable undescribable,
                           const recognition::IsCancelled& is_cancelled) {
  spdlog::info("event=redescribe views={} parameters={}", names.size(),
               LogField(parameters.Fingerprint()));
  std::vector<storage::DescriptorUpdate> updates;
  const auto store = [&] {
    absl::Status status = views.replace(updates);
    updates.clear();
    return status;
  };
  for (const std::string& name : names) {
    if (is_cancelled && is_cancelled()) {
      RETURN_IF_ERROR(store());
      return absl::CancelledError(std::string(views.when_cancelled));
    }
    const absl::StatusOr<storage::NewView> view = views.get(name);
    if (absl::IsNotFound(view.status())) continue;  // deleted meanwhile
    absl::StatusOr<storage::DescriptorRecord> descriptor =
        view.ok() ? DescribeAgain(*view, parameters) : view.status();
    if (absl::IsDataLoss(descriptor.status())) {
      LogLeftOut(name, descriptor.status());
      continue;
    }
    if (!view.ok()) return view.status();
    if (!descriptor.ok()) {
      absl::Status why = CannotDescribe(name, descriptor.status());
      if (undescribable == Undescribable::kIsAnError) return why;
      LogLeftOut(name, why);
      descriptor = NoDescriptor(parameters);
    }
    updates.push_back({name, view->record.content_digest(), {*std::move(descriptor)}});
    if (updates.size() < kRedescribeBatch) continue;
    RETURN_IF_ERROR(store());
  }
  return store();
}

}  // namespace

ViewCollector::ViewCollector(int size)
    : max_at_work_(std::max(1U, std::thread::hardware_concurrency())), index_(size) {}

void ViewCollector::Add(recognition::IndexedView view) {
  views_.push_back(view.view);
  portion_.push_back(std::move(view));
  if (portion_.size() == kPortion) HandOutPortion();
}

void ViewCollector::HandOutPortion() {
  if (at_work_.size() == max_at_work_) TakeOldest();
  auto work = [empty = index_.Empty(), portion = std::exchange(portion_, {})] {
    return empty.With(portion);
  };
  at_work_.push_back(std::async(std::launch::async, std::move(work)));
}

void ViewCollector::TakeOldest() {
  index_ = index_.Joined(at_work_.front().get());
  at_work_.pop_front();
}

LoadedViews ViewCollector::Finish(std::int64_t revision) {
  HandOutPortion();
  while (!at_work_.empty()) TakeOldest();
  return {revision, std::move(index_), std::move(views_)};
}

absl::Status Redescribe(storage::Catalogue& catalogue, const std::vector<std::string>& names,
                        const recognition::DescriptorParameters& parameters,
                        const recognition::IsCancelled& is_cancelled) {
  return RedescribeAll(StoreOf(catalogue), names, parameters, Undescribable::kIsAnError,
                       is_cancelled);
}

absl::Status DescribeObject(storage::Catalogue& catalogue, const std::string& object,
                            const recognition::DescriptorParameters& parameters) {
  std::vector<std::string> undescribed;
  const auto add_from = [&](const std::string& pose) -> absl::Status {
    std::string after;
    for (bool more = true; more;) {
      ASSIGN_OR_RETURN(const auto views, catalogue.ListViews(pose, kRedescribeBatch, after));
      for (const storage::ViewRecord& view : views.records) {
        if (FindDescriptor(view, parameters) == nullptr) undescribed.push_back(view.name());
        after = view.name();
      }
      more = views.more;
    }
    return absl::OkStatus();
  };
  std::string after;
  for (bool more = true; more;) {
    ASSIGN_OR_RETURN(const auto poses, catalogue.ListStablePoses(object, kRedescribeBatch, after));
    for (const v1::StablePose& pose : poses.records) {
      RETURN_IF_ERROR(add_from(pose.name()));
      after = pose.name();
    }
    more = poses.more;
  }
  if (undescribed.empty()) return absl::OkStatus();
  return RedescribeAll(StoreOf(catalogue), undescribed, parameters, Undescribable::kIsLeftOut, {});
}

absl::Status DescribeStaged(storage::Catalogue& catalogue, const storage::UploadRecord& upload,
                            const recognition::DescriptorParameters& parameters,
                            const recognition::IsCancelled& is_cancelled) {
  std::vector<std::string> undescribed;
  const auto note = [&](const storage::ViewRecord& view) -> absl::Status {
    if (is_cancelled && is_cancelled()) return absl::CancelledError(std::string(kCommitCancelled));
    if (FindDescriptor(view, parameters) == nullptr && !IsUndescribable(view, parameters)) {
      undescribed.push_back(view.name());
    }
    return absl::OkStatus();
  };
  absl::Status visited = catalogue.uploads().ForEachView(upload, note);
  if (!visited.ok() || undescribed.empty()) return visited;
  return RedescribeAll(StoreOf(catalogue.uploads(), upload), undescribed, parameters,
                       Undescribable::kIsLeftOut, is_cancelled);
}

absl::StatusOr<LoadedViews> ReadViews(const storage::Catalogue& catalogue,
                                      const recognition::DescriptorParameters& parameters,
                                      storage::RecordVisitor others,
                                      std::vector<std::string>* undescribed) {
  ViewCollector collector(recognition::DescriptorSize(parameters.kind));
  std::vector<std::string> left_out;
  others.view = [&](const storage::ViewRecord& record) {
    if (FindDescriptor(record, parameters) == nullptr && !IsUndescribable(record, parameters)) {
      undescribed->push_back(record.name());
      return absl::OkStatus();
    }
    auto view = IndexedViewFromRecord(record, parameters);
    if (view.ok()) {
      collector.Add(*std::move(view));
    } else {
      LogLeftOut(record.name(), view.status());
      left_out.push_back(record.name());
    }
    return absl::OkStatus();
  };
  ASSIGN_OR_RETURN(const std::int64_t revision, catalogue.ForEach(others));
  LoadedViews out = collector.Finish(revision);
  out.left_out = std::move(left_out);
  return out;
}

}  // namespace graspdb::server
