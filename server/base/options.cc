#include "server/base/options.h"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <map>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/connections/listen_address.h"
#include "program/connections/loopback.h"
#include "program/metrics/metrics_flags.h"
#include "program/settings_file.h"
#include "program/version.h"
#include "recognition/descriptors/descriptor.h"

namespace graspdb::server {
namespace {

constexpr char kFooter[] =
    R"(Every flag can also be set by an environment variable (--max-points is
GRASPDB_MAX_POINTS) or a key in the file of --config (max-points=1000000).

Example: graspdb-server --db /var/lib/graspdb --listen 127.0.0.1:50051
graspdb-server token NAME makes a token for a caller; graspdb-server health checks a running one.
SIGTERM or Ctrl-C stops it after the running calls have finished.
"graspdb-server backup --help" lists, verifies and restores backups without a server.
Exit status: 0 stopped by a signal, 1 could not start, 2 wrong usage.)";

// "24h" to 86400.
CLI::AsNumberWithUnit Duration() {
  const std::map<std::string, double> seconds = {
      {"s", 1}, {"m", 60}, {"h", 3600}, {"d", 24 * 3600}};
  return CLI::AsNumberWithUnit(seconds, CLI::AsNumberWithUnit::DEFAULT, "DURATION");
}

void AddBackupFlags(CLI::App& app, ServerOptions* o) {
  CLI::Option* folder = app.add_option("--backup-dir", o->backup_dir,
                                       "Folder of the backups, on another disk than the database");
  app.add_option("--backup-every", o->backup_every_s,
                 "Interval of backups, e.g. 24h (s, m, h, d); 0: none are scheduled")
      ->transform(Duration())
      ->check(CLI::Range(0.0, 366 * 24 * 3600.0))
      ->needs(folder)
      ->capture_default_str();
  app.add_option("--backup-keep", o->backup_keep,
                 "Number of backups that are kept when a scheduled one was made; 0: all")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  app.add_option(
         "--backup-max-age", o->backup_max_age_s,
         "Age at which backups are deleted when a scheduled one was made, e.g. 30d; 0: never")
      ->transform(Duration())
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--backup-rate", o->backup_rate_mib,
                 "Maximum MiB a second that a backup copies; 0: no limit")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
}

void AddServerSecurityFlags(CLI::App& app, ServerOptions* o) {
  app.add_flag("--allow-remote-without-tls", o->allow_remote_without_tls,
               "Allow listening on non-loopback addresses without encryption");
  app.add_option("--tls-cert", o->tls.cert,
                 "File with the server's certificate (PEM), for TLS; read again when it changes");
  app.add_option("--tls-key", o->tls.key, "File with the private key of --tls-cert (PEM)");
  app.add_option("--tls-client-ca", o->tls.client_ca,
                 "File with the authorities that sign clients' certificates (PEM), for mutual TLS");
  app.add_flag("--require-client-cert", o->tls.require_client_cert,
               "Refuse connections without a client certificate");
  app.add_option(
      "--identities", o->identities,
      "File of callers and their roles, see graspdb-server token --help; read again when "
      "it changes. Default: every caller may make all calls");
  app.add_option("--audit-log", o->audit_log,
                 "File for a line of JSON for each call that changes something or is refused");
  app.add_option("--audit-log-mib", o->audit_log_mib,
                 "Size at which it is renamed, MiB; ten full files are kept")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
}

void AddFlags(CLI::App& app, ServerOptions* o) {
  app.add_option("--db", o->database, "Directory of the database; created if missing")->required();
  app.add_option("--listen", o->listen, "HOST:PORT to listen on; port 0 selects a free one")
      ->capture_default_str();
  AddServerSecurityFlags(app, o);
  app.add_flag("--no-reflection", o->no_reflection,
               "Do not serve server reflection, by which tools read the contract");
  AddMetricsFlags(app, &o->metrics);
  const auto number = [&](const char* flag, auto* value, const char* text, double lo, double hi) {
    app.add_option(flag, *value, text)->check(CLI::Range(lo, hi))->capture_default_str();
  };
  number("--workers", &o->workers, "Frames processed at once; 0: one per core", 0, 1024);
  app.add_option("--queue", o->queue,
                 "Maximum number of waiting frames; more are rejected; one per worker, at least 2, "
                 "if not given")
      ->check(CLI::Range(0, 100'000));
  number("--max-points", &o->max_points, "Maximum number of points in a frame", 10, 100e6);
  number("--max-message-mib", &o->max_message_mib, "Maximum size of a message, MiB", 1, 1024);
  number(
      "--memory-mib", &o->memory_mib,
      "Memory of the server, MiB, for caches, requests and calls; 0: half of the machine's memory",
      0, 1 << 24);
  number("--cache-mib", &o->cache_mib,
         "Part of --memory-mib for models and clouds of views, MiB; 0: half of it", 0, 1 << 24);
  number(
      "--disk-reserve-mib", &o->disk_reserve_mib,
      "Space of the database's disk, MiB, that is kept for deletions, the start and compactions, "
      "at most a sixteenth of the disk; 0: none",
      0, 1 << 20);
  number("--keep-changes", &o->keep_changes, "Number of change records that are kept", 1, 1e9);
  app.add_option(
         "--deleted-objects-kept", o->deleted_objects_kept_s,
         "Time in which deleted objects and earlier revisions of objects can be brought back, "
         "e.g. 30d (s, m, h, d)")
      ->transform(Duration())
      ->check(CLI::Range(0.0, 3660 * 24 * 3600.0))
      ->default_str("30d");
  AddBackupFlags(app, o);
  number("--drain", &o->drain_s, "Maximum seconds to wait for running calls when stopping", 0,
         3600);
  number("--voxel-size", &o->voxel_size_m,
         "Edge of a voxel, m; a change recomputes the descriptors of all views", 0.0005, 0.1);
  number("--normal-radius", &o->normal_radius_m, "Radius of the normal estimation, m", 0.001, 0.5);
  app.add_option("--descriptor", o->descriptor, "Descriptor that finds the views")
      ->check(CLI::IsMember(recognition::DescriptorNames()))
      ->capture_default_str();
  app.add_option("--index", o->index, "Without effect: every search is exact (ADR 42)")
      ->check(CLI::IsMember({"exact", "flann"}))
      ->group("");  // hidden; settings of earlier versions have it
  app.add_option("--log-level", o->log_level, "Level of the log on stderr")
      ->check(CLI::IsMember({"debug", "info", "warn", "error", "off"}))
      ->capture_default_str();
}

}  // namespace

ParsedOptions ParseOptions(int argc, char** argv) {
  ParsedOptions out;
  CLI::App app(
      "graspdb-server stores the catalogue of taught views and recognises objects in frames.",
      "graspdb-server");
  app.set_version_flag("--version", absl::StrCat("graspdb-server ", kVersion));
  app.footer(kFooter);
  AddFlags(app, &out.options);
  AddSettingsFile(app);
  const std::optional<int> end = ParseArguments(app, argc, argv);
  out.done = end.has_value();
  out.exit_status = end.value_or(0);
  return out;
}

absl::Status CheckListenAddress(const ServerOptions& options) {
  ASSIGN_OR_RETURN(const ListenAddress listen, ParseListenAddress("--listen", options.listen));
  const bool is_encrypted = !options.tls.cert.empty();
  if (!is_encrypted && !options.allow_remote_without_tls && !IsLoopback(listen.host)) {
    return absl::FailedPreconditionError(absl::StrCat(
        "--listen ", options.listen,
        " can be reached from other machines without encryption; "
        "give --tls-cert and --tls-key, listen on 127.0.0.1, or add --allow-remote-without-tls if "
        "the network is trusted"));
  }
  return absl::OkStatus();
}

void WarnIfOpen(const ServerOptions& options) {
  if (IsLoopback(options.listen.substr(0, options.listen.rfind(':')))) return;
  if (options.tls.cert.empty() && !options.identities.empty()) {
    spdlog::warn("event=tokens_unencrypted advice=\"give --tls-cert and --tls-key\"");
  } else if (options.identities.empty() && !options.tls.require_client_cert) {
    spdlog::warn("event=open_to_network advice=\"give --identities, or --require-client-cert\"");
  }
}

}  // namespace graspdb::server
