// A server and the command line, as processes, in a folder of the test.
#pragma once

#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "graspdb/v1/catalog_service.pb.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "tests/end_to_end/process.h"
#include "tests/files/temporary_folder.h"

namespace graspdb::end_to_end {

class ProgramsTest : public ::testing::Test {
 protected:
  // Starts a server on the database `name`; its address in address_.
  void StartServer(const std::string& name = "db", const std::vector<std::string>& flags = {});
  // Runs `graspdb` with these arguments to its end.
  Finished Graspdb(std::vector<std::string> words) const;
  // The same, which must exit with 0.
  Finished Succeed(const std::vector<std::string>& words) const;
  // The same, running.
  std::unique_ptr<Process> StartGraspdb(std::vector<std::string> words) const;
  // Arguments as a command line of the server.
  static std::vector<std::string> ServerCommand(const std::string& database,
                                                const std::string& listen);

  // Captures of three sample parts on a turntable (TEACH), and random scenes (QUERY).
  void Simulate(const std::string& set, int step_deg, int scenes) const;
  v1::CatalogStatus Status() const;
  // The answers of `recognize --json --omit-timings` to the QUERY scenes of a set: lines.
  std::string Recognize(const std::string& set) const;
  // The arguments for them.
  std::vector<std::string> RecognizeWords(const std::string& set) const;
  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }

  files::TemporaryFolder folder_;
  std::unique_ptr<Process> server_;
  std::string address_;
};

// The response in a line of `recognize --json`; empty for a line without one.
std::optional<v1::RecognizeResponse> ResponseOf(const std::string& line);
// Number of lines of `recognize --json` with the object in their path.
int CountRight(const std::string& lines);
// Number of lines.
int CountLines(const std::string& text);

}  // namespace graspdb::end_to_end
