#include "server/options.h"

#include <CLI/CLI.hpp>

#include "absl/strings/str_cat.h"
#include "program/listen_address.h"
#include "program/settings_file.h"
#include "program/version.h"
#include "recognition/descriptors/descriptor.h"

namespace graspdb::server {
namespace {

constexpr char kFooter[] =
    R"(Every flag can also be set by an environment variable (--max-points is
GRASPDB_MAX_POINTS) or a key in the file of --config (max-points=1000000).

Example: graspdb-server --db /var/lib/graspdb --listen 127.0.0.1:50051
SIGTERM or Ctrl-C stops it after the running calls have finished.
Exit status: 0 stopped by a signal, 1 could not start, 2 wrong usage.)";

void AddFlags(CLI::App& app, ServerOptions* o) {
  app.add_option("--db", o->database, "Directory of the database; created if missing")->required();
  app.add_option("--listen", o->listen, "HOST:PORT to listen on; port 0 selects a free one")
      ->capture_default_str();
  app.add_flag("--allow-remote-without-tls", o->allow_remote_without_tls,
               "Allow listening on non-loopback addresses, without encryption or authentication");
  const auto number = [&](const char* flag, auto* value, const char* text, double lo, double hi) {
    app.add_option(flag, *value, text)->check(CLI::Range(lo, hi))->capture_default_str();
  };
  number("--workers", &o->workers, "Frames processed at once; 0: one per core", 0, 1024);
  number("--queue", &o->queue, "Maximum number of waiting frames; more are rejected", 0, 100000);
  number("--max-points", &o->max_points, "Maximum number of points in a frame", 10, 100e6);
  number("--max-message-mib", &o->max_message_mib, "Maximum size of a message, MiB", 1, 1024);
  number(
      "--memory-mib", &o->memory_mib,
      "Memory of the server, MiB, for caches, requests and calls; 0: half of the machine's memory",
      0, 1 << 24);
  number("--cache-mib", &o->cache_mib,
         "Part of --memory-mib for models and clouds of views, MiB; 0: half of it", 0, 1 << 24);
  number("--keep-changes", &o->keep_changes, "Number of change records that are kept", 1, 1e9);
  number("--drain", &o->drain_s, "Maximum seconds to wait for running calls when stopping", 0,
         3600);
  number("--voxel-size", &o->voxel_size_m,
         "Edge of a voxel, m; a change recomputes the descriptors of all views", 0.0005, 0.1);
  number("--normal-radius", &o->normal_radius_m, "Radius of the normal estimation, m", 0.001, 0.5);
  app.add_option("--descriptor", o->descriptor, "Descriptor that finds the views")
      ->check(CLI::IsMember(recognition::DescriptorNames()))
      ->capture_default_str();
  app.add_option("--index", o->index,
                 "Search for the nearest views: exact compares all views; flann compares some "
                 "thousand, for catalogues of 100,000 views and more")
      ->check(CLI::IsMember({"exact", "flann"}))
      ->capture_default_str();
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
  const absl::StatusOr<ListenAddress> listen = ParseListenAddress("--listen", options.listen);
  if (!listen.ok()) return listen.status();
  if (!options.allow_remote_without_tls && !IsLoopback(listen->host)) {
    return absl::FailedPreconditionError(absl::StrCat(
        "--listen ", options.listen,
        " can be reached from other machines without encryption; "
        "listen on 127.0.0.1, or add --allow-remote-without-tls if the network is trusted"));
  }
  return absl::OkStatus();
}

}  // namespace graspdb::server
