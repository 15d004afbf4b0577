#include "client/cell/sensors/sensor_spec.h"

#include <algorithm>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "base/status_macros.h"

namespace graspdb::client {
namespace {

absl::Status Bad(const std::string& text, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("the sensor \"", text, "\" ", what));
}

absl::Status ParseOptions(const std::string& text, const std::string& options, char separator,
                          SensorSpec* spec) {
  if (options.empty()) return absl::OkStatus();
  for (const std::string& option :
       static_cast<std::vector<std::string>>(absl::StrSplit(options, separator))) {
    const std::size_t equals = option.find('=');
    const std::string key = option.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : option.substr(equals + 1);
    if (key.empty()) return Bad(text, "has an option without a key; write key=value");
    if (!spec->options.emplace(key, value).second) {
      return Bad(text, absl::StrCat("has the option ", key, " twice; leave one"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<SensorSpec> ParseSensorSpec(const std::string& text) {
  const std::size_t colon = text.find_first_of(":?");
  SensorSpec spec;
  spec.kind = text.substr(0, colon);
  if (spec.kind.empty()) return Bad(text, "has no kind; write as \"freenect:0\"");
  if (colon == std::string::npos) return spec;
  spec.target = text.substr(text[colon] == ':' ? colon + 1 : colon);
  if (spec.kind == "simulated") {
    const std::string options = std::exchange(spec.target, "");
    RETURN_IF_ERROR(ParseOptions(text, options, ',', &spec));
    return spec;
  }
  const std::size_t mark = spec.target.rfind('?');
  if (mark == std::string::npos) return spec;
  const std::string options = spec.target.substr(mark + 1);
  const std::string first_key = options.substr(0, options.find('='));
  if (first_key.find_first_of("/.") != std::string::npos) return spec;  // it belongs to the path
  spec.target.resize(mark);
  RETURN_IF_ERROR(ParseOptions(text, options, '&', &spec));
  return spec;
}

std::optional<std::string> SensorOptions::Take(const std::string& key) {
  known_.push_back(key);
  const auto option = rest_.find(key);
  if (option == rest_.end()) return std::nullopt;
  std::string value = std::move(option->second);
  rest_.erase(option);
  return value;
}

void SensorOptions::Complain(const std::string& key, const std::string& what) {
  if (complaint_.empty()) complaint_ = absl::StrCat("the sensor's option ", key, " ", what);
}

bool SensorOptions::Flag(const std::string& key) {
  const std::optional<std::string> value = Take(key);
  if (!value) return false;
  bool flag = true;
  if (!value->empty() && !absl::SimpleAtob(*value, &flag)) Complain(key, "is not true or false");
  return flag;
}

std::string SensorOptions::Text(const std::string& key, const std::string& fallback) {
  const std::optional<std::string> value = Take(key);
  if (!value) return fallback;
  if (value->empty()) Complain(key, "has no value");
  return *value;
}

double SensorOptions::Number(const std::string& key, double fallback, double min, double max) {
  const std::optional<std::string> value = Take(key);
  if (!value) return fallback;
  double number = 0;
  if (!absl::SimpleAtod(*value, &number) || !(number >= min && number <= max)) {
    Complain(key, absl::StrCat("is \"", *value, "\" and no number from ", min, " to ", max));
    return fallback;
  }
  return number;
}

int SensorOptions::Integer(const std::string& key, int fallback, int min, int max) {
  const std::optional<std::string> value = Take(key);
  if (!value) return fallback;
  int number = 0;
  if (!absl::SimpleAtoi(*value, &number) || number < min || number > max) {
    Complain(key, absl::StrCat("is \"", *value, "\" and no whole number from ", min, " to ", max));
    return fallback;
  }
  return number;
}

std::optional<recognition::CameraIntrinsics> SensorOptions::Intrinsics(int width, int height) {
  constexpr double kMaxPixels = 100'000;
  const auto is_given = [this](const char* key) { return rest_.contains(key); };
  const char* const keys[] = {"fx", "fy", "cx", "cy"};
  const bool any = std::ranges::any_of(keys, is_given) || is_given("width") || is_given("height");
  for (const char* key : keys) {
    if (any && !is_given(key)) Complain(key, "is missing; give fx, fy, cx and cy together");
  }
  const recognition::CameraIntrinsics out = {
      .width = Integer("width", width, 1, static_cast<int>(kMaxPixels)),
      .height = Integer("height", height, 1, static_cast<int>(kMaxPixels)),
      .fx = Number("fx", 1, 1, kMaxPixels),
      .fy = Number("fy", 1, 1, kMaxPixels),
      .cx = Number("cx", 0, -kMaxPixels, kMaxPixels),
      .cy = Number("cy", 0, -kMaxPixels, kMaxPixels)};
  return any ? std::optional(out) : std::nullopt;
}

std::uint64_t SensorOptions::Seed(const std::string& key, std::uint64_t fallback) {
  const std::optional<std::string> value = Take(key);
  std::uint64_t seed = fallback;
  if (value && !absl::SimpleAtoi(*value, &seed)) Complain(key, "is no whole number");
  return seed;
}

std::vector<std::string> SensorOptions::List(const std::string& key) {
  const std::optional<std::string> value = Take(key);
  if (!value) return {};
  if (value->empty()) Complain(key, "has no value");
  return absl::StrSplit(*value, '+');
}

absl::Status SensorOptions::Finish(const std::string& kind) {
  if (!complaint_.empty()) return absl::InvalidArgumentError(complaint_ + "; correct it");
  if (rest_.empty()) return absl::OkStatus();
  std::sort(known_.begin(), known_.end());
  return absl::InvalidArgumentError(absl::StrCat(
      "a sensor of the kind ", kind, " has no option \"", rest_.begin()->first, "\"; ",
      known_.empty() ? "it has none" : absl::StrCat("it has ", absl::StrJoin(known_, ", "))));
}

}  // namespace graspdb::client
