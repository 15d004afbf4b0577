#include "server/status/status_metrics.h"

#include <iterator>
#include <optional>
#include <utility>

#include "absl/time/time.h"
#include "program/log/background_log.h"
#include "program/tls/pem_files.h"
#include "program/version.h"
#include "storage/uploads/uploads.h"

namespace graspdb::server {
namespace {

// Records of bulk uploads in one read.
constexpr std::size_t kUploadPage = 1000;

template <typename T>
Sample Number(T value) {
  return {static_cast<double>(value)};
}

template <typename T>
Sample Labelled(const char* label, const char* value, T number) {
  return {static_cast<double>(number), {{label, value}}};
}

MetricFamilies ProcessMetrics(absl::Time start) {
  return {GaugeOf("graspdb_build_info", "1, with the version of the program.",
                  {Labelled("version", kVersion, 1)}),
          GaugeOf("process_start_time_seconds", "Start of the server, Unix time.",
                  {Number(absl::ToDoubleSeconds(start - absl::UnixEpoch()))}),
          GaugeOf("process_resident_memory_bytes", "Resident memory of the server.",
                  {Number(ResidentBytes())})};
}

MetricFamilies CatalogueMetrics(const StatusSources& from) {
  const storage::CatalogueCounts counts = from.catalogue.counts();
  const auto snapshot = from.live.snapshot();
  MetricFamilies out = {
      GaugeOf("graspdb_serving",
              "1 while the index has all changes of the catalogue; else 0, and the health service "
              "reports NOT_SERVING.",
              {Number(from.live.agrees())}),
      GaugeOf("graspdb_catalogue_revision", "Revision of the catalogue on the disk.",
              {Number(from.catalogue.revision())}),
      GaugeOf("graspdb_index_revision",
              "Revision of the catalogue that frames are recognised with.",
              {Number(snapshot->revision)}),
      GaugeOf("graspdb_index_views", "Views in the index.", {Number(snapshot->index.view_count())}),
      GaugeOf("graspdb_catalogue_records", "Records of the catalogue.",
              {Labelled("kind", "object", counts.objects),
               Labelled("kind", "stable_pose", counts.stable_poses),
               Labelled("kind", "view", counts.views), Labelled("kind", "cell", counts.cells)}),
      GaugeOf("graspdb_left_out_records",
              "Records that this server cannot use; the log has event=record_left_out.",
              {Number(from.live.left_out_count())})};
  return out;
}

MetricFamilies CallPlaceMetrics(const CallPlaces& places) {
  using Kind = CallPlaces::Kind;
  return {GaugeOf("graspdb_calls_in_progress", "Calls from their start to the end of their answer.",
                  {Labelled("kind", "unary", places.used(Kind::kUnary)),
                   Labelled("kind", "stream", places.used(Kind::kStream))}),
          GaugeOf("graspdb_call_places", "Maximum number of calls in progress; more are rejected.",
                  {Labelled("kind", "unary", places.limit(Kind::kUnary)),
                   Labelled("kind", "stream", places.limit(Kind::kStream))})};
}

MetricFamilies QueueMetrics(const StatusSources& from) {
  const std::pair<const char*, const Admission*> queues[] = {{"recognise", &from.recognizing},
                                                             {"teach", &from.teaching},
                                                             {"bulk_upload", &from.uploading}};
  std::vector<Sample> waiting;
  std::vector<Sample> places;
  std::vector<Sample> busy;
  std::vector<Sample> workers;
  for (const auto& [name, admission] : queues) {
    const Admission::Use use = admission->use();
    waiting.push_back(Labelled("queue", name, use.waiting));
    places.push_back(Labelled("queue", name, use.places));
    busy.push_back(Labelled("queue", name, use.working));
    workers.push_back(Labelled("queue", name, use.slots));
  }
  return {GaugeOf("graspdb_queue_waiting", "Calls and frames that wait.", std::move(waiting)),
          GaugeOf("graspdb_queue_places",
                  "Maximum number of calls and frames that may wait; more are rejected.",
                  std::move(places)),
          GaugeOf("graspdb_workers_busy", "Calls and frames in progress.", std::move(busy)),
          GaugeOf("graspdb_workers", "Maximum number of calls and frames in progress.",
                  std::move(workers))};
}

MetricFamilies MemoryMetrics(const StatusSources& from) {
  const CacheUse models = from.clouds.model_use();
  const CacheUse pair_models = from.clouds.pair_model_use();
  const CacheUse clouds = from.clouds.cloud_use();
  const RequestMemory::Use requests = from.request_memory.use();
  const auto all = [&](auto CacheUse::*value) -> std::vector<Sample> {
    return {Labelled("cache", "models", models.*value),
            Labelled("cache", "pair_models", pair_models.*value),
            Labelled("cache", "clouds", clouds.*value)};
  };
  return {CounterOf("graspdb_cache_hits_total", "Values that were found in a cache.",
                    all(&CacheUse::hits)),
          CounterOf("graspdb_cache_misses_total", "Values that were not found in a cache.",
                    all(&CacheUse::misses)),
          CounterOf("graspdb_cache_rejected_total",
                    "Values that were not cached, being larger than half the cache.",
                    all(&CacheUse::rejected)),
          GaugeOf("graspdb_cache_bytes", "Size of a cache.", all(&CacheUse::bytes)),
          GaugeOf("graspdb_cache_budget_bytes", "Maximum size of a cache.",
                  all(&CacheUse::byte_budget)),
          GaugeOf("graspdb_memory_budget_bytes", "Memory of the whole server (--memory-mib).",
                  {Number(from.memory.total)}),
          GaugeOf("graspdb_request_memory_bytes", "Memory of the requests in progress.",
                  {Number(requests.bytes)}),
          GaugeOf("graspdb_request_memory_budget_bytes",
                  "Maximum memory of the requests in progress.", {Number(from.memory.requests)}),
          CounterOf("graspdb_request_memory_refused_total",
                    "Requests that were rejected for lack of memory for requests.",
                    {Number(requests.refused)})};
}

MetricFamilies DatabaseMetrics(const storage::Catalogue& catalogue) {
  const storage::DatabaseStatus status = catalogue.database_status();
  return {
      GaugeOf("graspdb_database_table_bytes", "RocksDB: sorted files.",
              {Number(status.table_bytes)}),
      GaugeOf("graspdb_database_blob_bytes", "RocksDB: blob files, which have the clouds.",
              {Number(status.blob_bytes)}),
      GaugeOf("graspdb_database_memtable_bytes", "RocksDB: memtables.",
              {Number(status.memtable_bytes)}),
      GaugeOf("graspdb_database_block_cache_bytes", "RocksDB: block cache.",
              {Number(status.block_cache_bytes)}),
      GaugeOf("graspdb_database_pending_compaction_bytes",
              "RocksDB: estimate of what compactions have to rewrite.",
              {Number(status.pending_compaction_bytes)}),
      GaugeOf("graspdb_database_running_compactions", "RocksDB: running compactions.",
              {Number(status.running_compactions)}),
      CounterOf("graspdb_database_background_errors_total",
                "RocksDB: failed flushes and compactions.", {Number(status.background_errors)}),
      GaugeOf("graspdb_database_writes_stopped", "1 while writes wait for compactions, else 0.",
              {Number(status.writes_stopped)}),
      GaugeOf("graspdb_database_writes_failed",
              "1 while changes are rejected, or would be, since the disk fails or is full; else "
              "0. Tried at least every 30 s.",
              {Number(!status.write_fault.error.ok())}),
      GaugeOf("graspdb_disk_available_bytes", "Free space of the database's file system.",
              {Number(status.disk_available_bytes)}),
      GaugeOf("graspdb_disk_bytes", "Size of the database's file system.",
              {Number(status.disk_bytes)})};
}

MetricFamilies BackupMetrics(const CatalogueBackups* backups) {
  std::vector<Sample> age;
  std::vector<Sample> count;
  std::vector<Sample> interval;
  std::vector<Sample> failed;
  if (backups != nullptr) {
    const v1::BackupStatus status = backups->Status();
    if (status.has_last_good_backup()) age.push_back(Number(status.last_good_age_s()));
    count.push_back(Number(status.backup_count()));
    interval.push_back(Number(status.interval_s()));
    failed.push_back(Number(!status.last_error().empty()));
  }
  return {GaugeOf("graspdb_backup_age_seconds",
                  "Time since the newest good backup was begun; none without one.", std::move(age)),
          GaugeOf("graspdb_backups", "Good backups; none without --backup-dir.", std::move(count)),
          GaugeOf("graspdb_backup_interval_seconds",
                  "Interval of scheduled backups; 0: none are scheduled.", std::move(interval)),
          GaugeOf("graspdb_backup_failed",
                  "1 if making, verifying or deleting a backup failed since the last one was made, "
                  "else 0.",
                  std::move(failed))};
}

// Nothing where the disk fails: other metrics show that.
MetricFamilies UploadMetrics(storage::Uploads& uploads) {
  std::int64_t open = 0;
  std::int64_t committed = 0;
  storage::StagedCounts staged;
  std::string last;
  for (bool more = true; more;) {
    const auto page = uploads.List(kUploadPage, last);
    if (!page.ok()) break;
    more = page->more;
    for (const storage::UploadRecord& upload : page->records) {
      last = upload.name();
      ++(upload.has_commit_time() ? committed : open);
      const auto counts = uploads.CountsOf(upload);
      if (!counts.ok()) continue;
      staged.views += counts->views;
      staged.errors += counts->errors;
    }
  }
  return {
      GaugeOf("graspdb_uploads", "Bulk uploads.",
              {Labelled("state", "open", open), Labelled("state", "committed", committed)}),
      GaugeOf(
          "graspdb_upload_views", "Views of open bulk uploads; failed: they cannot be taught.",
          {Labelled("state", "staged", staged.views), Labelled("state", "failed", staged.errors)})};
}

prometheus::MetricFamily CertificateMetric(const std::string& certificate) {
  std::vector<Sample> end;
  if (!certificate.empty()) {
    const auto time = CertificateEnd({"--tls-cert", certificate});
    if (time.ok()) end.push_back(Number(absl::ToDoubleSeconds(*time - absl::UnixEpoch())));
  }
  return GaugeOf("graspdb_certificate_end_time_seconds",
                 "When the certificate of --tls-cert expires, Unix time; none without one.",
                 std::move(end));
}

MetricFamilies FileMetrics(const StatusSources& from) {
  std::vector<Sample> failed;
  std::vector<Sample> lost;
  const auto add = [&](const char* name, const std::optional<FileFault>& fault) {
    failed.push_back(Labelled("file", name, fault.has_value()));
  };
  if (from.access.identities != nullptr) add("identities", from.access.identities->fault());
  if (!from.certificate.empty()) add("tls", from.tls_files.fault());
  if (from.access.audit != nullptr) {
    add("audit", from.access.audit->fault());
    lost.push_back(Number(from.access.audit->lost_count()));
  }
  return {
      GaugeOf("graspdb_file_failed",
              "1 while a file of the settings cannot be used as it is, else 0; none without its "
              "flag.",
              std::move(failed)),
      CounterOf("graspdb_audit_lost_records_total",
                "Audit records that could not be written; none without --audit-log.",
                std::move(lost))};
}

MetricFamilies StatusMetrics(const StatusSources& from) {
  MetricFamilies out;
  const auto add = [&](MetricFamilies families) {
    std::move(families.begin(), families.end(), std::back_inserter(out));
  };
  add(ProcessMetrics(from.start));
  add(CatalogueMetrics(from));
  add(CallPlaceMetrics(*from.access.places));
  add({CounterOf("graspdb_log_lost_lines_total",
                 "Lines of the log that were lost, as its reader did not read.",
                 {Number(LostLogLines())}),
       CounterOf("graspdb_connections_refused_total",
                 "Connections that were closed at once: beyond the limit of open files or of one "
                 "address, or within 10 s after another one of their address was ended.",
                 {Number(from.acceptor.refused_count())}),
       CounterOf("graspdb_connections_ended_total",
                 "Connections that were ended since their clients abandoned many calls, or took "
                 "memory without sending a message.",
                 {Number(from.access.connections->ended_count())})});
  add(QueueMetrics(from));
  add(MemoryMetrics(from));
  add(DatabaseMetrics(from.catalogue));
  add(BackupMetrics(from.backups));
  add(UploadMetrics(from.catalogue.uploads()));
  add({CertificateMetric(from.certificate)});
  add(FileMetrics(from));
  return out;
}

}  // namespace

absl::StatusOr<std::unique_ptr<MetricsServer>> ServeMetrics(const MetricsOptions& options,
                                                            const StatusSources& sources,
                                                            const CallMetrics* calls) {
  return MetricsServer::Start(options, [sources, calls] {
    MetricFamilies out = StatusMetrics(sources);
    for (prometheus::MetricFamily& family : calls->Collect()) out.push_back(std::move(family));
    return out;
  });
}

}  // namespace graspdb::server
