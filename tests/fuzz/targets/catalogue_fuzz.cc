// Sequences of calls of all services on a catalogue that is empty at first.
#include <cstdint>

#include "tests/fuzz/calls.h"
#include "tests/fuzz/message_target.h"
#include "tests/fuzz/requirement.h"

namespace graspdb::fuzz {
namespace {

// A new database after this many inputs, since it keeps every change in memory.
constexpr int kInputsOfDatabase = 500;
constexpr int kInputsOfStart = 50;
constexpr int kMaxOperations = 16;

const std::vector<std::string>& Words() {
  static const std::vector<std::string> words = {"a",
                                                 "b",
                                                 "objects/a",
                                                 "objects/b",
                                                 "flat",
                                                 "v",
                                                 "objects/a/stablePoses/flat",
                                                 "top",
                                                 "x",
                                                 "objects/a/stablePoses/flat/views/v",
                                                 "cells/a",
                                                 "y",
                                                 "objects/b/stablePoses/flat",
                                                 "display_name",
                                                 "z",
                                                 "objects/b/stablePoses/flat/views/v",
                                                 "labels",
                                                 "grasps",
                                                 "release",
                                                 "include_drafts",
                                                 "symmetry_order",
                                                 "min_score",
                                                 "mesh_pose",
                                                 "sensor_pose",
                                                 "uploads/a",
                                                 "*",
                                                 "pipeline.min_score",
                                                 ""};
  return words;
}

void Run(const Operations& operations) {
  static FuzzServer server;
  static int inputs = 0;
  if (operations.operations_size() > kMaxOperations) return;
  if (inputs % kInputsOfDatabase == 0) server.StartAnew();
  ++inputs;
  Calls calls(server);
  for (const Operation& operation : operations.operations()) {
    calls.Do(operation);
    calls.RequireCounted();
  }
  calls.RequireReadable();
  if (inputs % kInputsOfStart == 0) {
    const auto before = calls.Listed();
    server.Restart();
    Require(calls.Listed() == before, "the same objects after a start");
  }
  calls.DeleteAll();
}

}  // namespace
}  // namespace graspdb::fuzz

GRASPDB_FUZZ_MESSAGES(graspdb::fuzz::Operations, graspdb::fuzz::Words(), graspdb::fuzz::Run)
