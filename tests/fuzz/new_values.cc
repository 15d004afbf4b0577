// New field values of MessageMutator.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "tests/fuzz/message_mutator.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace graspdb::fuzz {
namespace {

using Limits = std::numeric_limits<float>;

// Maximum length of a string field after one mutation.
constexpr std::size_t kMaxGrowth = 64;
constexpr std::size_t kMaxFloats = 4096;

constexpr std::array<std::int64_t, 18> kIntegers = {0,
                                                    1,
                                                    -1,
                                                    2,
                                                    3,
                                                    4,
                                                    8,
                                                    12,
                                                    16,
                                                    255,
                                                    256,
                                                    65535,
                                                    65536,
                                                    1'000'000,
                                                    2'000'001,
                                                    std::numeric_limits<std::int32_t>::max(),
                                                    std::numeric_limits<std::int32_t>::min(),
                                                    std::numeric_limits<std::int64_t>::max()};

constexpr std::array<double, 22> kNumbers = {0.0,
                                             -0.0,
                                             1.0,
                                             -1.0,
                                             0.003,
                                             0.01,
                                             0.5,
                                             1e-9,
                                             1e-30,
                                             1e9,
                                             1e20,
                                             -1e20,
                                             100.0,
                                             100.001,
                                             static_cast<double>(Limits::max()),
                                             static_cast<double>(Limits::denorm_min()),
                                             static_cast<double>(Limits::min()),
                                             std::numeric_limits<double>::max(),
                                             std::numeric_limits<double>::denorm_min(),
                                             std::numeric_limits<double>::quiet_NaN(),
                                             std::numeric_limits<double>::infinity(),
                                             -std::numeric_limits<double>::infinity()};

float GetFloat(const std::string& bytes, std::size_t index) {
  float value = 0;
  std::memcpy(&value, bytes.data() + index * sizeof(value), sizeof(value));
  return value;
}

void SetFloat(float value, std::size_t index, std::string& bytes) {
  std::memcpy(bytes.data() + index * sizeof(value), &value, sizeof(value));
}

std::string MutatedBytes(std::string old) {
  const std::size_t size = old.size();
  old.resize(size + kMaxGrowth);
  old.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(old.data()), size, old.size()));
  return old;
}

}  // namespace

std::int64_t MessageMutator::NewInteger(std::int64_t old) {
  const auto wrapped = static_cast<std::uint64_t>(old);
  switch (Pick(4)) {
    case 0:
      return static_cast<std::int64_t>(wrapped + 1);
    case 1:
      return static_cast<std::int64_t>(wrapped - 1);
    case 2:
      return static_cast<std::int64_t>(OneIn(2) ? wrapped * 2 : wrapped / 2);
    default:
      return kIntegers[Pick(kIntegers.size())];
  }
}

double MessageMutator::NewNumber(double old) {
  switch (Pick(6)) {
    case 0:
      return -old;
    case 1:
      return old * (OneIn(2) ? 10 : 0.1);
    case 2:
      return old + static_cast<double>(Pick(2001)) / 1000 - 1;
    case 3:
      return std::nextafter(old, OneIn(2) ? 1e300 : -1e300);
    default:
      return kNumbers[Pick(kNumbers.size())];
  }
}

int MessageMutator::NewEnum(const google::protobuf::FieldDescriptor& field) {
  const auto values = static_cast<std::size_t>(field.enum_type()->value_count());
  return OneIn(8) ? static_cast<int>(Pick(1000))
                  : field.enum_type()->value(static_cast<int>(Pick(values)))->number();
}

std::string MessageMutator::NewText(std::string old) {
  if (!words_.empty() && !OneIn(3)) return words_[Pick(words_.size())];
  std::string text = OneIn(16) ? std::string(Pick(5000), 'x') : MutatedBytes(std::move(old));
  // Strings are UTF-8: the parser rejects others. Two-byte characters represent all non-ASCII ones.
  for (char& c : text) c = static_cast<unsigned char>(c) >= 0x80 ? '~' : c;
  if (OneIn(16)) text += "\xc3\xa4";
  return text;
}

std::string MessageMutator::NewBytes(std::string old) {
  switch (Pick(4)) {
    case 0:
      return MutatedBytes(std::move(old));
    case 1:
      return NewSize(std::move(old));
    default:
      return old.size() < sizeof(float) ? NewSize(std::move(old)) : NewFloats(std::move(old));
  }
}

std::string MessageMutator::NewSize(std::string old) {
  if (!old.empty() && OneIn(2)) {
    old.resize(OneIn(2) ? Pick(old.size()) : old.size() - 1);
  } else {
    // Whole points of three floats, so that a cloud stays valid.
    constexpr std::size_t kPointBytes = 3 * sizeof(float);
    const std::size_t points = 1 + Pick(64);
    for (std::size_t i = 0; i < points * kPointBytes; ++i) {
      old.push_back(old.size() < kPointBytes ? '\x3e' : old[old.size() - kPointBytes]);
    }
  }
  return old;
}

// Bytes as the coordinates of a packed cloud.
std::string MessageMutator::NewFloats(std::string old) {
  const std::size_t count = std::min(old.size() / sizeof(float), kMaxFloats);
  const std::size_t first = Pick(count);
  const std::size_t run =
      1 + (OneIn(3) ? Pick(count - first) : std::min(Pick(3), count - first - 1));
  const std::size_t how = Pick(5);
  const float value = static_cast<float>(NewNumber(static_cast<double>(GetFloat(old, first))));
  for (std::size_t i = first; i < first + run; ++i) {
    const float now = GetFloat(old, i);
    const std::array<float, 5> changed = {value, now + value, now * value,
                                          GetFloat(old, first + (i - first) % 3),
                                          GetFloat(old, Pick(count))};
    SetFloat(changed[how], i, old);
  }
  return old;
}

}  // namespace graspdb::fuzz
