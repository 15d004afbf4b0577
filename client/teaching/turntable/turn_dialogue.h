// The dialogue with a person who turns an object before the camera, step by step.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <string>

#include "client/sdk/client.h"
#include "client/teaching/turntable/teaching_prompt.h"
#include "client/teaching/turntable/turntable_coverage.h"
#include "client/teaching/turntable/view_taking.h"

namespace graspdb::client {

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

}  // namespace graspdb::client
