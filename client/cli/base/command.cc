#include "client/cli/base/command.h"

#include <google/protobuf/util/json_util.h>

#include <atomic>
#include <csignal>
#include <cstdio>

#include "absl/strings/cord.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/base/json_object.h"
#include "program/standard_streams.h"

namespace graspdb::client {
namespace {

constexpr char kWrongUsageMark[] = "graspdb/wrong-usage";

std::atomic<bool> interrupted = false;

extern "C" void OnInterrupt(int /*signal*/) { interrupted.store(true); }

}  // namespace

Client Connect(const GlobalOptions& options) {
  return Client({.server = options.server,
                 .timeout = absl::Seconds(options.timeout_s),
                 .busy_retries = options.busy_retries,
                 .security = options.security});
}

CLI::App* AddCommand(CLI::App& parent, const std::string& name, const std::string& description) {
  CLI::App* command = parent.add_subcommand(name, description);
  command->fallthrough();
  return command;
}

CLI::Validator WholeNumberFrom(std::int64_t least) {
  const auto error = [least](const std::string& text) -> std::string {
    std::int64_t number = 0;
    if (absl::SimpleAtoi(text, &number) && number >= least) return "";
    return absl::StrCat("give a whole number of ", least, " or more, not ", text);
  };
  return {error, absl::StrCat(">= ", least)};
}

absl::StatusOr<std::string> ToJson(const google::protobuf::Message& message) {
  std::string text;
  const auto status = google::protobuf::util::MessageToJsonString(message, &text);
  if (!status.ok()) return absl::InternalError(absl::StrCat("no JSON: ", status.ToString()));
  return text;
}

absl::StatusOr<google::protobuf::Struct> ToDocument(const google::protobuf::Message& message) {
  ASSIGN_OR_RETURN(const std::string text, ToJson(message));
  google::protobuf::Struct out;
  const auto status = google::protobuf::util::JsonStringToMessage(text, &out);
  if (!status.ok()) return absl::InternalError(absl::StrCat("no JSON: ", status.ToString()));
  return out;
}

absl::Status PrintJson(const google::protobuf::Message& message) {
  ASSIGN_OR_RETURN(std::string text, ToJson(message));
  std::printf("%s\n", text.c_str());
  return absl::OkStatus();
}

absl::Status PrintJson(const google::protobuf::Struct& document) {
  ASSIGN_OR_RETURN(const std::string text,
                   files::PrintDocument(document, files::JsonLayout::kOneLine));
  std::printf("%s\n", text.c_str());
  return absl::OkStatus();
}

bool WriteOutput() { return FlushOutput().ok(); }

absl::Status WrongUsage(absl::Status status) {
  status.SetPayload(kWrongUsageMark, absl::Cord());
  return status;
}

bool HasWrongUsageMark(const absl::Status& status) {
  return status.GetPayload(kWrongUsageMark).has_value();
}

absl::Status WithMessage(const absl::Status& status, const std::string& message) {
  absl::Status out(status.code(), message);
  status.ForEachPayload([&](absl::string_view type_url, const absl::Cord& payload) {
    out.SetPayload(type_url, payload);
  });
  return out;
}

bool Interrupted() {
  static const bool watching = [] {
    struct sigaction action {};
    action.sa_handler = OnInterrupt;
    action.sa_flags = static_cast<int>(SA_RESETHAND);  // the second Ctrl-C ends the process
    sigaction(SIGINT, &action, nullptr);
    return true;
  }();
  return watching && interrupted.load();
}

}  // namespace graspdb::client
