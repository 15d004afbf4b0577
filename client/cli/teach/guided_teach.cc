#include "client/cli/teach/guided_teach.h"

#include <cstdio>
#include <memory>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cli/base/camera.h"
#include "client/cli/base/taught_report.h"
#include "client/cli/teach/console_prompt.h"
#include "client/teaching/turntable/guided_teaching.h"

namespace graspdb::client {

absl::Status RunGuidedTeach(const GlobalOptions& global, const GuidedTeachOptions& options) {
  Client client = Connect(global);
  const absl::StatusOr<v1::Cell> cell = client.GetCell(ResourceName("cells", options.cell));
  if (absl::IsNotFound(cell.status())) {
    return absl::NotFoundError(absl::StrCat("there is no cell ", options.cell,
                                            " with the camera's pose; empty the table and run "
                                            "`graspdb cells level ",
                                            options.cell, " --sensor ", options.sensor, "`"));
  }
  if (!cell.ok()) return cell.status();
  ASSIGN_OR_RETURN(const std::unique_ptr<DepthSensor> sensor, OpenCamera(options.sensor));
  GuidedOptions guided{
      .object_id = options.object,
      .display_name = options.display_name.empty() ? options.object : options.display_name,
      .cell = *cell,
      .axis = {},
      .plate_height_m = options.plate_height_m,
      .step_deg = options.step_deg,
      .clockwise = options.clockwise};
  if (!options.axis.empty()) guided.axis = Eigen::Vector2d(options.axis[0], options.axis[1]);
  ConsolePrompt console(stdin, global.json ? stderr : stdout);
  UnattendedPrompt prompt(console, options.unattended);
  ASSIGN_OR_RETURN(const GuidedCounts counts,
                   GuidedTeaching(*sensor, client, prompt, guided).Run());
  absl::Status reported =
      ReportTaught(global, client, {.created = counts.taught},
                   counts.stopped ? "; run the same command again to go on" : "")
          .status();
  if (!reported.ok() || !counts.stopped || !options.unattended.yes) return reported;
  return absl::FailedPreconditionError(
      "teaching stopped before all views were taught; see the message of the last view");
}

}  // namespace graspdb::client
