#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/blackbox/bundle_files.h"
#include "client/cell/blackbox/replay.h"
#include "client/cli/recognize/commands.h"
#include "files/base/json_object.h"

namespace graspdb::client {
namespace {

constexpr char kReplayFooter[] =
    R"(A folder stands for its bundles. The responses must be identical bit for bit, except for
measured times, the revision and the id of the catalogue. Exit status: 0 all identical, 1 some
differ or are unreadable, 3 no server reachable.

A folder of bundles is a regression test for a new build of the server, or for a change of
the catalogue, which may change responses.

With --json each bundle prints one line: {"bundle", "same", "revisionThen", "revisionNow",
"differences"} or {"bundle", "error"}.

Examples:
  graspdb replay /var/lib/graspdb/bundles
  graspdb replay bundles/0000000012-20260703T091500Z.bundle --json)";

struct Tally {
  std::size_t same = 0;
  std::size_t different = 0;
  std::size_t unreadable = 0;
};

absl::Status PrintUnreadable(bool as_json, const std::string& path, const absl::Status& why) {
  if (!as_json) {
    std::printf("unreadable  %s: %s\n", path.c_str(), std::string(why.message()).c_str());
    return absl::OkStatus();
  }
  google::protobuf::Struct line;
  files::JsonObject(&line).Set(files::Json("bundle", path),
                               files::Json("error", std::string(why.message())));
  return PrintJson(line);
}

absl::Status PrintResult(bool as_json, const std::string& path, const ReplayResult& result) {
  if (as_json) {
    google::protobuf::Struct line;
    files::JsonObject(&line).Set(files::Json("bundle", path), files::Json("same", result.is_same),
                                 files::Json("revisionThen", result.revision_then),
                                 files::Json("revisionNow", result.revision_now),
                                 files::Json("differences", result.differences));
    return PrintJson(line);
  }
  const bool other_revision = result.revision_now != 0 && result.revision_then != 0 &&
                              result.revision_then != result.revision_now;
  std::printf("%s  %s%s\n", result.is_same ? "same      " : "different ", path.c_str(),
              other_revision ? absl::StrCat("  (revision ", result.revision_then, ", now ",
                                            result.revision_now, ")")
                                   .c_str()
                             : "");
  for (const std::string& difference : result.differences) {
    std::printf("            %s\n", difference.c_str());
  }
  return absl::OkStatus();
}

absl::Status ReplayOne(Client& client, bool as_json, const std::filesystem::path& path,
                       Tally* tally) {
  const absl::StatusOr<v1::Bundle> bundle = ReadBundle(path);
  if (!bundle.ok()) {
    ++tally->unreadable;
    return PrintUnreadable(as_json, path.string(), bundle.status());
  }
  const auto now = client.Recognize(ReplayRequest(*bundle));
  const bool was_unavailable =
      bundle->has_error() &&
      bundle->error().code() == static_cast<int>(absl::StatusCode::kUnavailable);
  // An unreachable server is not a difference, unless the bundle has this error.
  if (absl::IsUnavailable(now.status()) && !was_unavailable) return now.status();
  const ReplayResult result = CompareReplay(*bundle, now);
  ++(result.is_same ? tally->same : tally->different);
  return PrintResult(as_json, path.string(), result);
}

absl::Status Replay(const GlobalOptions& global, const std::vector<std::string>& inputs) {
  ASSIGN_OR_RETURN(const std::vector<std::filesystem::path> paths, ListBundles(inputs));
  Client client = Connect(global);
  Tally tally;
  for (const std::filesystem::path& path : paths) {
    if (!WriteOutput()) return absl::OkStatus();
    if (Interrupted()) return absl::CancelledError("interrupted");
    RETURN_IF_ERROR(ReplayOne(client, global.json, path, &tally));
  }
  std::fflush(stdout);
  const std::string summary =
      absl::StrCat(tally.same, " same, ", tally.different, " different, ", tally.unreadable,
                   " unreadable of ", paths.size(), " bundles");
  if (tally.same < paths.size()) return absl::FailedPreconditionError(summary);
  if (!global.json) std::printf("%s\n", summary.c_str());
  return absl::OkStatus();
}

}  // namespace

void AddReplayCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* command = AddCommand(
      app, "replay", "Resend the requests that a cell recorded and compare the responses");
  auto inputs = std::make_shared<std::vector<std::string>>();
  command->add_option("BUNDLE", *inputs, "Bundle files, or folders of them")->required();
  command->footer(kReplayFooter);
  command->callback([=, &global] { *action = [=, &global] { return Replay(global, *inputs); }; });
}

}  // namespace graspdb::client
