#include "tests/end_to_end/process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <sstream>
#include <thread>

#include "tests/files/temporary_folder.h"

namespace graspdb::end_to_end {
namespace {

constexpr auto kPause = std::chrono::milliseconds(10);

std::filesystem::path FreshFile(const std::filesystem::path& folder, const char* kind) {
  static std::atomic<int> count = 0;
  return folder / (std::to_string(count++) + "." + kind);
}

}  // namespace

Process::Process(const std::filesystem::path& folder, const std::vector<std::string>& command)
    : out_(FreshFile(folder, "out")), err_(FreshFile(folder, "err")) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out_.c_str(), kFlags, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err_.c_str(), kFlags, 0600);
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  if (posix_spawn(&pid_, arguments[0], &actions, nullptr, arguments.data(), environ) != 0) {
    pid_ = -1;
    ended_ = true;
    status_ = 127 << 8;
  }
  posix_spawn_file_actions_destroy(&actions);
}

Process::~Process() {
  if (HasEnded()) return;
  Signal(SIGKILL);
  Wait();
}

void Process::Signal(int signal) const {
  if (pid_ > 0 && !ended_) kill(pid_, signal);
}

bool Process::HasEnded() {
  if (!ended_ && waitpid(pid_, &status_, WNOHANG) == pid_) ended_ = true;
  return ended_;
}

Finished Process::Wait() {
  if (!ended_ && waitpid(pid_, &status_, 0) == pid_) ended_ = true;
  Finished out;
  out.exit_status = WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  out.out = files::BytesOf(out_);
  out.err = files::BytesOf(err_);
  return out;
}

std::string Process::WaitForLine(const std::string& start) {
  for (;;) {
    const bool ended = HasEnded();  // checked before reading, so that no output is missed
    std::istringstream printed(files::BytesOf(out_));
    std::string line;
    while (std::getline(printed, line)) {
      if (line.starts_with(start) && !printed.eof()) return line.substr(start.size());
    }
    if (ended) return "";
    std::this_thread::sleep_for(kPause);
  }
}

std::string Process::Errors() const { return files::BytesOf(err_); }

bool Process::WaitForError(const std::string& text) {
  for (;;) {
    const bool ended = HasEnded();  // as above
    if (Errors().find(text) != std::string::npos) return true;
    if (ended) return false;
    std::this_thread::sleep_for(kPause);
  }
}

Finished RunProgram(const std::filesystem::path& folder, const std::vector<std::string>& command) {
  return Process(folder, command).Wait();
}

}  // namespace graspdb::end_to_end
