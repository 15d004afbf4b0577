// The dialogue with a person who turns an object before the camera, step by step.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/sdk/client.h"
#include "client/teaching/turntable/turntable_coverage.h"
#include "client/teaching/turntable/view_taking.h"

namespace graspdb::client {

// Prefixes of the prompts that a script must distinguish, as Enter would repeat them for ever.
inline constexpr char kStablePosePrompt[] = "id of the stable pose";
inline constexpr char kViewPrompt[] = "turn the object to ";

// A person at a terminal, or a script. Called from one thread; need not be thread-safe.
class TeachingPrompt {
 public:
  virtual ~TeachingPrompt() = default;

  // Prints a line; `text` has no line end.
  virtual void Print(const std::string& text) = 0;

  // Prints a question and returns the answer without its line end; nothing at the end of the input.
  virtual std::optional<std::string> ReadLine(const std::string& question) = 0;
};

// How the object is turned.
struct Turning {
  std::string stable_pose;                           // resource name
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // of the object, world frame, m
  bool clockwise = false;                            // seen from above
};

// Teaches the missing views of one turn. Each view is stored once it is reported. Not thread-safe.
class TurnDialogue {
 public:
  // All must outlive this.
  TurnDialogue(ViewTaker& taker, Client& client, TeachingPrompt& prompt,
               TurntableCoverage& coverage, Turning turning);

  // Prompts for every missing step; false when the person stops. If a view fails, prints the error
  // and prompts for the step again.
  bool Run();
  // Views that were taught, repeated ones too.
  int taught() const { return taught_; }

 private:
  // Whether the step is done.
  bool Teach(int step);
  bool IsWanted(int step, const TakenView& taken);
  void Report(int step, const TakenView& taken);
  void Remove(const std::string& view);

  ViewTaker& taker_;
  Client& client_;
  TeachingPrompt& prompt_;
  TurntableCoverage& coverage_;
  const Turning turning_;
  std::deque<int> todo_;
  int last_ = -1;
  int taught_ = 0;
  bool reported_axis_ = false;
};

// Moving a turn that was taught about a wrong axis to the right one: the next three functions may
// be called from any thread, but not concurrently for one stable pose.

// Teaches the stored views of a stable pose (a resource name) again, with the object's origin above
// `axis` (world frame, m), and deletes the old ones. All are taught before the first is deleted:
// after an interruption no view is lost, and some exist twice. `region` is that of the cell. Errors
// of the server.
absl::Status MoveTurn(Client& client, const std::string& stable_pose, const Eigen::Vector2d& axis,
                      const std::optional<v1::AxisAlignedBox>& region);

// The views of a stable pose (a resource name) that are not of the turn at `origin` (world frame,
// m), as after an interrupted move; none if all are of that turn, or none is. Errors of the server.
absl::StatusOr<std::vector<v1::View>> LeftByMove(Client& client, const std::string& stable_pose,
                                                 const Eigen::Vector3d& origin);

// Prompts whether to delete the views of LeftByMove, and deletes them. Errors of the server.
absl::Status OfferToEndMove(Client& client, TeachingPrompt& prompt, const std::string& stable_pose,
                            const Eigen::Vector3d& origin);

}  // namespace graspdb::client
