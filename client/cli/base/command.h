// Shared by the commands of `graspdb` and the other command-line programs.
#pragma once

#include <google/protobuf/struct.pb.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/sdk/client.h"
#include "client/sdk/resource_name.h"

namespace graspdb::client {

// Flags that may precede or follow any command.
struct GlobalOptions {
  std::string server = "127.0.0.1:50051";
  double timeout_s = 30;
  int busy_retries = ConnectionOptions().busy_retries;
  bool json = false;
  bool verbose = false;
  SecurityOptions security = {};
};

// The chosen command, run after the command line was parsed.
using Action = std::function<absl::Status()>;

// A client that connects as the flags specify.
Client Connect(const GlobalOptions& options);

// A command with the given name under `parent`; global flags may follow it.
CLI::App* AddCommand(CLI::App& parent, const std::string& name, const std::string& description);

// Accepts whole numbers that are not smaller; CLI11's PositiveNumber prints the largest double.
CLI::Validator WholeNumberFrom(std::int64_t least);

// Prints a message as one line of canonical JSON on stdout.
absl::Status PrintJson(const google::protobuf::Message& message);

// Prints a document as one line of JSON on stdout, its keys in alphabetical order.
absl::Status PrintJson(const google::protobuf::Struct& document);

// Writes at once what was printed, for the next program in a pipe. False if it cannot be written: a
// command that would print more ends with OK, and main() prints the reason and returns 1.
bool WriteOutput();

// A message as one line of canonical JSON.
absl::StatusOr<std::string> ToJson(const google::protobuf::Message& message);

// The same as a document, to which a command adds what belongs to the message.
absl::StatusOr<google::protobuf::Struct> ToDocument(const google::protobuf::Message& message);

// Marks the error of a command line that could be parsed but is wrong: `graspdb` ends with 2.
absl::Status WrongUsage(absl::Status status);
bool HasWrongUsageMark(const absl::Status& status);

// The same error with another text; its details stay.
absl::Status WithMessage(const absl::Status& status, const std::string& message);

// True after Ctrl-C was pressed; the first call installs the signal handler.
bool Interrupted();

// Replaces this process with `program`, which is installed beside this one and gets `arguments`.
// Returns only if that fails.
absl::Status BecomeProgram(const std::string& program, std::vector<std::string> arguments);

// The flags that may precede or follow any command.
void AddGlobalFlags(CLI::App& app, GlobalOptions* global);

// Reads the command line into `app`, whose commands set `action`, and runs that. Returns the exit
// status: 0 done, 1 failed, 2 wrong usage, 3 no server reachable. A settings file may have sections
// of `other_commands`, which belong to another program.
int RunCommandLine(CLI::App& app, const GlobalOptions& global, const Action& action,
                   std::vector<std::string> other_commands, int argc, char** argv);

}  // namespace graspdb::client
