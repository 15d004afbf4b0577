// Runs the other process of the tests.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>

namespace graspdb::storage {

// Started by the constructor; killed and waited for by the destructor at the latest.
class ChildProcess {
 public:
  // `what` is one of the commands of other_process.cc.
  ChildProcess(const std::string& what, const std::string& database,
               const std::string& backups = "");
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // The next revision that it reports; nullopt once it has ended.
  std::optional<std::int64_t> NextRevision();
  // Ends its standard input.
  void CloseInput();
  // kill -9. Earlier reports can still be read.
  void Kill();
  // Waits for its end; returns its wait status.
  int Wait();

 private:
  pid_t pid_ = -1;
  int input_ = -1;
  int output_ = -1;
};

}  // namespace graspdb::storage
