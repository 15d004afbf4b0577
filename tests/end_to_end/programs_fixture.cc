#include "tests/end_to_end/programs_fixture.h"

#include <sstream>

namespace graspdb::end_to_end {

std::vector<std::string> ProgramsTest::ServerCommand(const std::string& database,
                                                     const std::string& listen) {
  return {GRASPDB_SERVER_PROGRAM, "--db", database, "--listen", listen};
}

void ProgramsTest::StartServer(const std::string& name, const std::vector<std::string>& flags) {
  std::vector<std::string> command = ServerCommand(Path(name), "127.0.0.1:0");
  command.insert(command.end(), flags.begin(), flags.end());
  server_ = std::make_unique<Process>(folder_.path(), command);
  address_ = server_->WaitForLine("listening on ");
  ASSERT_NE(address_, "") << server_->Errors();
}

std::unique_ptr<Process> ProgramsTest::StartGraspdb(std::vector<std::string> words) const {
  words.insert(words.begin(), {GRASPDB_PROGRAM, "--server", address_});
  return std::make_unique<Process>(folder_.path(), words);
}

Finished ProgramsTest::Graspdb(std::vector<std::string> words) const {
  return StartGraspdb(std::move(words))->Wait();
}

Finished ProgramsTest::Succeed(const std::vector<std::string>& words) const {
  Finished done = Graspdb(words);
  EXPECT_EQ(done.exit_status, 0) << done.err;
  return done;
}

void ProgramsTest::Simulate(const std::string& set, int step_deg, int scenes) const {
  const Finished done = Graspdb({"simulate", "--parts", "l-bracket,flange,handle", "--turntable",
                                 "--step", std::to_string(step_deg), "--random",
                                 std::to_string(scenes), "--seed", "5", "--out", Path(set)});
  ASSERT_EQ(done.exit_status, 0) << done.err;
}

v1::CatalogStatus ProgramsTest::Status() const {
  const Finished done = Graspdb({"status", "--json"});
  EXPECT_EQ(done.exit_status, 0) << done.err;
  v1::CatalogStatus status;
  EXPECT_TRUE(google::protobuf::util::JsonStringToMessage(done.out, &status).ok()) << done.out;
  return status;
}

std::string ProgramsTest::Recognize(const std::string& set) const {
  return Succeed(RecognizeWords(set)).out;
}

std::vector<std::string> ProgramsTest::RecognizeWords(const std::string& set) const {
  return {"recognize", Path(set), "--split", "QUERY", "--json", "--omit-timings"};
}

int CountLines(const std::string& text) {
  return static_cast<int>(std::count(text.begin(), text.end(), '\n'));
}

std::optional<v1::RecognizeResponse> ResponseOf(const std::string& line) {
  const std::string key = "\"response\":";
  const std::size_t at = line.find(key);
  if (at == std::string::npos || !line.ends_with('}')) return std::nullopt;
  const std::string json = line.substr(at + key.size(), line.size() - at - key.size() - 1);
  v1::RecognizeResponse response;
  if (!google::protobuf::util::JsonStringToMessage(json, &response).ok()) return std::nullopt;
  return response;
}

int CountRight(const std::string& lines) {
  int right = 0;
  std::istringstream in(lines);
  std::string line;
  while (std::getline(in, line)) {
    const std::optional<v1::RecognizeResponse> response = ResponseOf(line);
    if (!response || response->detections().empty()) continue;
    if (response->detections(0).object().empty()) continue;
    const std::string id = response->detections(0).object().substr(std::string("objects/").size());
    right += line.substr(0, line.find("response")).find(id) != std::string::npos ? 1 : 0;
  }
  return right;
}

}  // namespace graspdb::end_to_end
