#include "server/load_views.h"

#include <spdlog/spdlog.h>

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "logging/log_field.h"
#include "server/convert.h"
#include "server/index_snapshot.h"
#include "server/records.h"

namespace graspdb::server {
namespace {

constexpr std::size_t kRedescribeBatch = 256;

// A view that cannot be described with these parameters.
absl::Status CannotDescribe(const std::string& name, const absl::Status& status) {
  return {status.code(),
          absl::StrCat(name, " cannot be described with these parameters: ", status.message(),
                       "; start with the --voxel-size and --normal-radius that it was taught with, "
                       "or delete it with them first")};
}

// Describes the named views again, and stores the result.
absl::Status Redescribe(storage::Catalogue& catalogue, const std::vector<std::string>& names,
                        const recognition::DescriptorParameters& parameters) {
  if (names.empty()) return absl::OkStatus();
  spdlog::info("event=redescribe views={} parameters={}", names.size(),
               LogField(parameters.Fingerprint()));
  std::vector<storage::DescriptorUpdate> updates;
  for (std::size_t i = 0; i < names.size(); ++i) {
    absl::StatusOr<storage::ViewRecord> record = catalogue.GetView(names[i]);
    if (!record.ok()) return record.status();
    absl::StatusOr<std::string> packed = catalogue.GetPackedCloud(names[i]);
    if (!packed.ok()) return packed.status();
    absl::StatusOr<recognition::Pose> sensor = PoseFromProto(record->sensor_pose(), "sensor_pose");
    if (!sensor.ok()) return sensor.status();
    absl::StatusOr<recognition::OrientedCloud> cloud =
        CloudFromPacked(*packed, *sensor, parameters);
    if (!cloud.ok()) return cloud.status();
    absl::StatusOr<storage::DescriptorRecord> descriptor =
        MakeDescriptorRecord(*cloud, *sensor, parameters);
    if (!descriptor.ok()) return CannotDescribe(names[i], descriptor.status());
    updates.push_back({names[i], {*std::move(descriptor)}});
    if (updates.size() < kRedescribeBatch && i + 1 < names.size()) continue;
    if (auto revision = catalogue.ReplaceDescriptors(updates); !revision.ok()) {
      return revision.status();
    }
    updates.clear();
  }
  return absl::OkStatus();
}

// The views as the records have them; the names of those without the right descriptor in
// `outdated`, which are left out.
absl::StatusOr<LoadedViews> ReadRecords(const storage::Catalogue& catalogue,
                                        const recognition::DescriptorParameters& parameters,
                                        std::vector<std::string>* outdated) {
  ViewCollector collector(recognition::DescriptorSize(parameters.kind));
  const absl::StatusOr<std::int64_t> revision =
      catalogue.ForEachView([&](const storage::ViewRecord& record) {
        if (FindDescriptor(record, parameters) == nullptr) {
          outdated->push_back(record.name());
          return absl::OkStatus();
        }
        auto view = IndexedViewFromRecord(record, parameters);
        if (!view.ok()) return view.status();
        collector.Add(*std::move(view));
        return absl::OkStatus();
      });
  if (!revision.ok()) return revision.status();
  return collector.Finish(*revision);
}

}  // namespace

absl::StatusOr<LoadedViews> LoadViews(storage::Catalogue& catalogue,
                                      const recognition::DescriptorParameters& parameters) {
  absl::StatusOr<LoadedViews> kept = ReadIndexSnapshot(catalogue, parameters);
  if (kept.ok()) return kept;
  // A new database has nothing to rebuild an index of.
  if (catalogue.counts().views > 0) {
    spdlog::info("event=index_rebuild reason={}", LogField(std::string(kept.status().message())));
  }
  std::vector<std::string> outdated;
  absl::StatusOr<LoadedViews> read = ReadRecords(catalogue, parameters, &outdated);
  if (!read.ok() || outdated.empty()) return read;
  absl::Status described = Redescribe(catalogue, outdated, parameters);
  if (!described.ok()) return described;
  outdated.clear();
  return ReadRecords(catalogue, parameters, &outdated);
}

}  // namespace graspdb::server
