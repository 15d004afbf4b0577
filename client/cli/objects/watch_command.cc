#include <cstdio>
#include <memory>
#include <string>

#include "client/cli/objects/commands.h"

namespace graspdb::client {
namespace {

struct WatchOptions {
  std::int64_t after = -1;  // negative: the current revision
  std::string catalog_id;   // empty: any
  bool records = false;
  double heartbeat_s = 30;
};

void PrintChange(const v1::WatchCatalogResponse& response) {
  for (const v1::ResourceChange& change : response.changes()) {
    std::printf("%lld %s %s\n", static_cast<long long>(response.catalog_revision()),
                change.kind() == v1::CHANGE_KIND_DELETED ? "deleted" : "written",
                change.name().c_str());
  }
}

absl::Status Watch(const GlobalOptions& global, const WatchOptions& options) {
  v1::WatchCatalogRequest request;
  if (options.after >= 0) request.set_after_revision(options.after);
  request.set_catalog_id(options.catalog_id);
  request.set_include_records(options.records);
  request.set_heartbeat_s(options.heartbeat_s);
  bool is_written = true;
  const auto print = [&](const v1::WatchCatalogResponse& response) -> absl::Status {
    absl::Status printed;
    if (global.json) {
      printed = PrintJson(response);
    } else {
      PrintChange(response);
    }
    is_written = WriteOutput();
    return is_written ? printed : absl::CancelledError("the output cannot be written");
  };
  absl::Status watched = Connect(global).WatchCatalog(request, print);
  return is_written ? watched : absl::OkStatus();
}

}  // namespace

void AddWatchCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* command = AddCommand(app, "watch", "Print the changes of the catalogue as they happen");
  auto options = std::make_shared<WatchOptions>();
  command
      ->add_option("--after", options->after,
                   "Begin after this revision, 0 for all that are kept; default: new changes")
      ->check(WholeNumberFrom(0));
  command->add_option(
      "--catalog-id", options->catalog_id,
      "Id of the catalogue that --after is a revision of (graspdb status); fails if the "
      "server has another one, as after a restore");
  command->add_flag("--records", options->records,
                    "With --json also the changed records, but for views");
  command->add_option("--heartbeat", options->heartbeat_s, "Seconds between heartbeats (--json)")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  command->footer(
      "Ends with Ctrl-C. With --json each line has the revision in catalogRevision and the id of\n"
      "the catalogue in catalogId; continue with those of the last one without `continued`. It\n"
      "fails where the changes since then are not known: read all records again.\n\n"
      "Example: graspdb watch --after 0 --json | tee changes.jsonl");
  command->callback([=, &global] { *action = [=, &global] { return Watch(global, *options); }; });
}

}  // namespace graspdb::client
