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
    R"(Every flag is also a variable (--max-points is GRASPDB_MAX_POINTS) and a key of
the file given to --config (max-points=1000000).

Example: graspdb-server --db /var/lib/graspdb --listen 127.0.0.1:50051
Stop it with SIGTERM or Ctrl-C: it finishes what it has begun.
Exit status: 0 stopped as asked, 1 could not start, 2 wrong usage.)";

void AddFlags(CLI::App& app, ServerOptions* o) {
  app.add_option("--db", o->database, "Folder of the database; it is made when it is not there")
      ->required();
  app.add_option("--listen", o->listen, "HOST:PORT to listen on; port 0 picks a free one")
      ->capture_default_str();
  app.add_flag("--allow-remote-without-tls", o->allow_remote_without_tls,
               "Listen on other addresses than this machine's own, unencrypted and open to all");
  const auto number = [&](const char* flag, auto* value, const char* text, double lo, double hi) {
    app.add_option(flag, *value, text)->check(CLI::Range(lo, hi))->capture_default_str();
  };
  number("--workers", &o->workers, "Frames processed at once; 0: one a core", 0, 1024);
  number("--queue", &o->queue, "Frames that may wait; more are turned away", 0, 100000);
  number("--max-points", &o->max_points, "Points that a frame may have", 10, 100e6);
  number("--max-message-mib", &o->max_message_mib, "Size of a message, MiB", 1, 1024);
  number("--memory-mib", &o->memory_mib,
         "Memory of the server, MiB, shared out among caches, requests and calls; 0: half of what "
         "the machine has",
         0, 1 << 24);
  number("--cache-mib", &o->cache_mib, "Of that for models and clouds of views, MiB; 0: half of it",
         0, 1 << 24);
  number(
      "--keep-changes", &o->keep_changes,
      "Changes of the catalogue of which a record is kept; an index file that is behind by more is "
      "made anew at the start",
      1, 1e9);
  number("--drain", &o->drain_s, "Seconds that running calls get on a stop", 0, 3600);
  number("--voxel-size", &o->voxel_size_m,
         "Edge of a voxel, m; other values than those that views "
         "were taught with describe all views again",
         0.0005, 0.1);
  number("--normal-radius", &o->normal_radius_m, "Radius that a normal is fitted to, m", 0.001,
         0.5);
  app.add_option("--descriptor", o->descriptor, "Descriptor that finds the views")
      ->check(CLI::IsMember(recognition::DescriptorNames()))
      ->capture_default_str();
  app.add_option("--index", o->index,
                 "How the nearest views are found: exact looks at all; flann at some thousand, for "
                 "catalogues of 100,000 views and more")
      ->check(CLI::IsMember({"exact", "flann"}))
      ->capture_default_str();
  app.add_option("--log-level", o->log_level, "What goes to the log on stderr")
      ->check(CLI::IsMember({"debug", "info", "warn", "error", "off"}))
      ->capture_default_str();
}

}  // namespace

ParsedOptions ParseOptions(int argc, char** argv) {
  ParsedOptions out;
  CLI::App app("graspdb-server keeps the catalogue of taught views and recognises frames.",
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
