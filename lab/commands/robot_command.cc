#include <cstdio>
#include <memory>

#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cell/agent/jobs/cell_frames.h"
#include "client/cli/base/camera.h"
#include "files/base/json_object.h"
#include "lab/commands/commands.h"
#include "lab/simulated_robot/pick_run.h"
#include "program/base/latency_histogram.h"
#include "program/connections/listen_address.h"
#include "rendering/sample_parts.h"

namespace graspdb::lab {
namespace {

constexpr std::chrono::seconds kTimeout{60};
constexpr int kMaxJob = 65535;  // the interface has 16 bits for it

struct RobotOptions {
  std::string cell;
  std::string agent = "127.0.0.1:7100";
  std::vector<std::string> parts;
  PickRunOptions run;
  double min_percent = 0;
};

constexpr char kRobotFooter[] =
    R"(For every pick it places sample parts before the simulated camera of the cell's agent,
requests a grasp over the Generic Robot Interface, and prints whether a gripper would have held:
the tool within 3 mm and 2 degrees of a taught grasp, modulo the part's symmetry. Times are from
the trigger to the pose, without the camera's time. With --json every pick is one line, the
summary the last.

Example:
  graspdb-cell --cell demo --sensor simulated:scene=/tmp/table &
  graspdb robot --cell demo --scene /tmp/table --picks 20)";

std::string PickText(const Pick& pick) {
  if (pick.code != client::GriCode::kNoError) {
    return absl::StrFormat("%-16s not picked: %s", pick.shown,
                           std::string(client::GriCodeName(pick.code)));
  }
  return absl::StrFormat("%-16s %s: %s, %s, off by %.2f mm, %.2f deg; %.1f ms", pick.shown,
                         pick.held ? "held" : "LOST", pick.error.object, pick.error.grasp_id,
                         1000 * pick.error.shift_m, pick.error.turn_rad * 180 / std::numbers::pi,
                         std::chrono::duration<double, std::milli>(pick.latency).count());
}

double Milliseconds(std::chrono::duration<double, std::milli> time) { return time.count(); }

absl::Status PrintPick(bool as_json, const Pick& pick) {
  if (!as_json) {
    std::printf("%s\n", PickText(pick).c_str());
    return absl::OkStatus();
  }
  google::protobuf::Struct document;
  files::JsonObject object(&document);
  object.Set(files::Json("shown", pick.shown), files::Json("code", client::GriCodeName(pick.code)),
             files::Json("held", pick.held));
  if (pick.code == client::GriCode::kNoError) {
    object.Set(files::Json("object", pick.error.object), files::Json("grasp", pick.error.grasp_id),
               files::Json("shift_mm", 1000 * pick.error.shift_m),
               files::Json("turn_deg", pick.error.turn_rad * 180 / std::numbers::pi),
               files::Json("cycle_ms", Milliseconds(pick.latency)));
  }
  return client::PrintJson(document);
}

// The server knows the robot base of a cell.
absl::Status TakeBase(const client::GlobalOptions& global, RobotOptions* options) {
  if (options->cell.empty()) return absl::OkStatus();
  ASSIGN_OR_RETURN(v1::Cell cell,
                   client::Connect(global).GetCell(client::ResourceName("cells", options->cell)));
  ASSIGN_OR_RETURN(const client::CellFrames frames, client::FramesOf(cell));
  options->run.world_base = frames.world_base;
  return absl::OkStatus();
}

absl::Status PrintSummary(bool as_json, std::size_t held, std::size_t picks, double percent,
                          const LatencyHistogram& times) {
  const double p50_ms = Milliseconds(times.Percentile(50));
  const double p99_ms = Milliseconds(times.Percentile(99));
  if (!as_json) {
    const std::string latency = times.count() == 0
                                    ? "no pose was given"
                                    : absl::StrFormat(
                                          "from trigger to pose, without the camera: p50 %.1f "
                                          "ms, p99 %.1f ms",
                                          p50_ms, p99_ms);
    std::printf("%s\n", absl::StrFormat("%d of %d picks would have held (%.1f %%); %s", held, picks,
                                        percent, latency)
                            .c_str());
    return absl::OkStatus();
  }
  google::protobuf::Struct document;
  files::JsonObject object(&document);
  object.Set(files::Json("picks", picks), files::Json("held", held),
             files::Json("with_pose", times.count()));
  if (times.count() > 0)
    object.Set(files::Json("cycle_p50_ms", p50_ms), files::Json("cycle_p99_ms", p99_ms));
  return client::PrintJson(document);
}

absl::Status Summarise(bool as_json, const std::vector<Pick>& picks, double min_percent) {
  LatencyHistogram times;
  std::size_t held = 0;
  for (const Pick& pick : picks) {
    if (pick.held) ++held;
    if (pick.code != client::GriCode::kNoError) continue;
    times.Record(std::chrono::duration_cast<LatencyHistogram::Duration>(pick.latency));
  }
  const double percent = 100.0 * static_cast<double>(held) / static_cast<double>(picks.size());
  absl::Status printed = PrintSummary(as_json, held, picks.size(), percent, times);
  if (!printed.ok() || percent >= min_percent) return printed;
  return absl::InternalError(absl::StrFormat("fewer than %g %% would have held", min_percent));
}

absl::Status Run(const client::GlobalOptions& global, RobotOptions options) {
  ASSIGN_OR_RETURN(const std::vector<rendering::Workpiece> parts,
                   rendering::SampleParts(options.parts));
  RETURN_IF_ERROR(TakeBase(global, &options));
  ASSIGN_OR_RETURN(const ListenAddress agent, ParseListenAddress("--agent", options.agent));
  absl::StatusOr<client::GriClient> robot =
      client::GriClient::Connect(agent.host, agent.port, kTimeout);
  if (!robot.ok()) return client::NotOfServer(robot.status());
  absl::Status printed;
  const auto picks = RunPicks(*robot, parts, options.run, [&](const Pick& pick) {
    printed.Update(PrintPick(global.json, pick));
    std::fflush(stdout);
  });
  if (!picks.ok()) return client::NotOfServer(picks.status());
  if (!printed.ok()) return printed;
  return Summarise(global.json, *picks, options.min_percent);
}

void AddFlags(CLI::App* command, RobotOptions* options) {
  command->add_option("--agent", options->agent, "HOST:PORT of the agent's GRI")
      ->capture_default_str();
  command->add_option("--cell", options->cell, "Id of the cell, for its robot base pose");
  command
      ->add_option("--scene", options->run.scene,
                   "Folder that the agent's camera reads (--sensor simulated:scene=FOLDER)")
      ->required();
  command->add_option("--picks", options->run.picks, "Number of picks")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command->add_option("--objects-per-scene", options->run.objects_per_scene, "Objects on the table")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  command->add_option("--parts", options->parts, "Comma-separated ids of sample parts")
      ->delimiter(',')
      ->type_name("ID,...");
  command->add_option("--seed", options->run.seed, "Seed of the scenes")->capture_default_str();
  const CLI::Range jobs(0, kMaxJob);
  command->add_option("--job", options->run.job, "Job that returns grasps")
      ->check(jobs)
      ->capture_default_str();
  command
      ->add_option("--picked-job", options->run.picked_job, "Job to trigger after a pick that held")
      ->check(jobs);
  command
      ->add_option("--missed-job", options->run.missed_job, "Job to trigger after any other pick")
      ->check(jobs);
  command
      ->add_option("--min-percent,--least", options->min_percent,
                   "Fail below this percentage of picks that hold")
      ->check(CLI::Range(0, 100));
}

}  // namespace

void AddRobotCommand(CLI::App& app, const client::GlobalOptions& global, client::Action* action) {
  auto options = std::make_shared<RobotOptions>();
  CLI::App* command =
      client::AddCommand(app, "robot", "Pick with a simulated robot before a simulated camera");
  AddFlags(command, options.get());
  command->footer(kRobotFooter);
  command->callback([=, &global] { *action = [=, &global] { return Run(global, *options); }; });
}

}  // namespace graspdb::lab
