#include "tests/storage/child_process.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "gtest/gtest.h"

namespace graspdb::storage {

ChildProcess::ChildProcess(const std::string& what, const std::string& database,
                           const std::string& backups) {
  int input[2];
  int output[2];
  if (pipe2(input, O_CLOEXEC) != 0 || pipe2(output, O_CLOEXEC) != 0) std::abort();
  pid_ = fork();
  if (pid_ < 0) std::abort();
  if (pid_ == 0) {
    dup2(input[0], STDIN_FILENO);
    dup2(output[1], STDOUT_FILENO);
    execl(GRASPDB_OTHER_PROCESS, GRASPDB_OTHER_PROCESS, what.c_str(), database.c_str(),
          backups.c_str(), nullptr);
    _exit(127);
  }
  close(input[0]);
  close(output[1]);
  input_ = input[1];
  output_ = output[0];
}

ChildProcess::~ChildProcess() {
  if (pid_ > 0) {
    Kill();
    Wait();
  }
  CloseInput();
  close(output_);
}

std::optional<std::int64_t> ChildProcess::NextRevision() {
  std::int64_t revision = 0;
  if (read(output_, &revision, sizeof(revision)) != sizeof(revision)) return std::nullopt;
  return revision;
}

void ChildProcess::CloseInput() {
  if (input_ >= 0) close(input_);
  input_ = -1;
}

void ChildProcess::Kill() { EXPECT_EQ(kill(pid_, SIGKILL), 0); }

int ChildProcess::Wait() {
  int status = 0;
  EXPECT_EQ(waitpid(pid_, &status, 0), pid_);
  pid_ = -1;
  return status;
}

}  // namespace graspdb::storage
