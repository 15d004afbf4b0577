#include "client/cell/agent/settings/job_config.h"

#include <functional>
#include <set>
#include <string_view>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "base/status_macros.h"
#include "client/sdk/resource_name.h"

namespace graspdb::client {
namespace {

constexpr absl::Duration kMaxTimeLimit = absl::Minutes(10);

absl::Status Wrong(std::string_view what, std::string_view expected) {
  return absl::InvalidArgumentError(
      absl::StrCat(std::string(what), " is wrong; give ", std::string(expected)));
}

absl::Status ParseNumber(const std::string& text, double high, double* out) {
  double value = 0;
  if (!absl::SimpleAtod(text, &value) || !(value >= 0 && value <= high)) {
    return Wrong(absl::StrCat("\"", text, "\""), absl::StrCat("a number in 0 to ", high));
  }
  *out = value;
  return absl::OkStatus();
}

template <typename Integer>
absl::Status ParseWhole(const std::string& text, Integer low, Integer high, Integer* out) {
  Integer value = 0;
  if (!absl::SimpleAtoi(text, &value) || value < low || value > high) {
    return Wrong(absl::StrCat("\"", text, "\""),
                 absl::StrCat("a whole number in ", low, " to ", high));
  }
  *out = value;
  return absl::OkStatus();
}

template <typename Enum>
absl::Status ParseWord(const std::string& text,
                       const std::vector<std::pair<std::string, Enum>>& words, Enum* out) {
  std::string expected;
  for (const auto& [word, value] : words) {
    if (word == text) {
      *out = value;
      return absl::OkStatus();
    }
    absl::StrAppend(&expected, expected.empty() ? "" : ", ", word);
  }
  return Wrong(absl::StrCat("\"", text, "\""), absl::StrCat("one of ", expected));
}

absl::Status ParseLimit(const std::string& text, std::optional<absl::Duration>* out) {
  absl::Duration limit;
  if (!absl::ParseDuration(text, &limit) || limit <= absl::ZeroDuration() ||
      limit > kMaxTimeLimit) {
    return Wrong(absl::StrCat("\"", text, "\""), "a time such as 500ms or 2s, up to 10m");
  }
  *out = limit;
  return absl::OkStatus();
}

absl::Status SetId(const std::string& text, std::string* out) {
  if (text.empty()) return Wrong("an empty name", "an id");
  *out = text;
  return absl::OkStatus();
}

absl::Status SetObject(const std::string& text, std::string* out) {
  if (text.empty()) return Wrong("an empty object", "its id");
  *out = ResourceName("objects", text);
  return absl::OkStatus();
}

absl::Status SetGrasp(const std::string& text, JobConfig* job) {
  job->kind = JobKind::kShowGrasp;
  return SetId(text, job->shown_grasp.mutable_grasp_id());
}

// A length of the shown grasp, m.
absl::Status SetLength(const std::string& text, void (v1::Grasp::*set)(double), JobConfig* job) {
  double length_m = 0;
  RETURN_IF_ERROR(ParseNumber(text, 10, &length_m));
  (job->shown_grasp.*set)(length_m);
  return absl::OkStatus();
}

absl::Status SetPriority(const std::string& text, JobConfig* job) {
  int priority = 0;
  RETURN_IF_ERROR(ParseWhole<int>(text, -1000, 1000, &priority));
  job->shown_grasp.set_priority(priority);
  return absl::OkStatus();
}

absl::Status ApplyWord(const std::string& key, const std::string& value, JobConfig* job) {
  using Set = std::function<absl::Status()>;
  const std::map<std::string_view, Set> setters = {
      {"object", [&] { return SetObject(value, &job->object); }},
      {"label", [&] { return SetId(value, &job->label); }},
      {"show", [&] { return SetGrasp(value, job); }},
      {"primary",
       [&] {
         return ParseWord<JobPrimary>(
             value, {{"grasp", JobPrimary::kGrasp}, {"object", JobPrimary::kObject}},
             &job->primary);
       }},
      {"protocol",
       [&] {
         return ParseWord<JobProtocol>(
             value, {{"gri", JobProtocol::kGri}, {"line", JobProtocol::kLine}}, &job->protocol);
       }},
      {"outcome",
       [&] {
         return ParseWord<JobKind>(value,
                                   {{"picked", JobKind::kPicked},
                                    {"missed", JobKind::kMissed},
                                    {"slipped", JobKind::kSlipped}},
                                   &job->kind);
       }},
      {"limit", [&] { return ParseLimit(value, &job->time_limit); }},
      {"min-score", [&] { return ParseNumber(value, 1, &job->min_score); }},
      {"poses", [&] { return ParseWhole<std::size_t>(value, 1, 10000, &job->max_poses); }},
      {"opening", [&] { return SetLength(value, &v1::Grasp::set_gripper_opening_m, job); }},
      {"approach", [&] { return SetLength(value, &v1::Grasp::set_approach_distance_m, job); }},
      {"retreat", [&] { return SetLength(value, &v1::Grasp::set_retreat_distance_m, job); }},
      {"priority", [&] { return SetPriority(value, job); }},
  };
  const auto setter = setters.find(key);
  if (setter != setters.end()) return setter->second();
  std::string known;
  for (const auto& [name, set] : setters) absl::StrAppend(&known, " ", std::string(name), "=");
  return absl::InvalidArgumentError(
      absl::StrCat("\"", key, "=\" is unknown; the words are", known));
}

absl::Status ParseInto(const std::string& line, JobConfig* job) {
  const std::vector<std::string> words =
      absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
  if (words.size() < 2) return Wrong("it", "a number and what to do, such as \"1 any\"");
  RETURN_IF_ERROR(ParseWhole<int>(words[0], 0, 65535, &job->id));
  std::set<std::string> keys;
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (words[i] == "any") continue;
    const std::pair<std::string, std::string> word =
        absl::StrSplit(words[i], absl::MaxSplits('=', 1));
    RETURN_IF_ERROR(ApplyWord(word.first, word.second, job));
    if (!keys.insert(word.first).second) {
      return absl::InvalidArgumentError(absl::StrCat("\"", word.first, "=\" is given twice"));
    }
  }
  if (keys.contains("show") && keys.contains("outcome")) {
    return absl::InvalidArgumentError(
        "showing a grasp and reporting an outcome are two different jobs");
  }
  if (!job->object.empty() && !job->label.empty()) {
    return absl::InvalidArgumentError("an object and a label are two different jobs");
  }
  return absl::OkStatus();
}

constexpr char kJobHelp[] =
    R"(A job is a line: its number (0 to 65535), then words.
  1 any                                     all recognised objects
  2 object=flange primary=object            one object; object poses first, grasps related
  3 label=brackets min-score=0.8 poses=1    objects with that label, minimum score, best pose only
  4 any limit=500ms protocol=line           time limit; line protocol only
  80 show=top opening=0.06 object=flange    store the pose of the tool centre point as grasp "top"
  91 outcome=picked                         outcome of the last pose (picked, missed, slipped)
In the config file: job=["1 any","2 object=flange"])";

}  // namespace

v1::Grasp DefaultGrasp() {
  v1::Grasp out;
  out.set_approach_distance_m(0.1);
  out.set_retreat_distance_m(0.1);
  return out;
}

std::string JobHelp() { return kJobHelp; }

absl::StatusOr<JobConfig> ParseJob(const std::string& line) {
  JobConfig job;
  if (absl::Status status = ParseInto(line, &job); !status.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat("job \"", line, "\": ", std::string(status.message())));
  }
  return job;
}

absl::StatusOr<Jobs> ParseJobs(const std::vector<std::string>& lines) {
  Jobs out;
  for (const std::string& line : lines) {
    ASSIGN_OR_RETURN(JobConfig job, ParseJob(line));
    const int id = job.id;
    if (!out.emplace(id, std::move(job)).second) {
      return absl::InvalidArgumentError(
          absl::StrCat("job \"", line, "\": number ", id, " is taken by another job"));
    }
  }
  return out;
}

}  // namespace graspdb::client
