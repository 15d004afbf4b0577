#include "recognition/base/round_down.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace graspdb::recognition {
namespace {

TEST(RoundDownTest, IsTheFloor) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (int i = -2000; i <= 2000; ++i) {
    for (const double number : {i / 2.0, i / 7.0, i * 1e12}) {
      for (const double near : {number, std::nextafter(number, kInfinity),
                                std::nextafter(number, -kInfinity), -number}) {
        ASSERT_EQ(static_cast<double>(RoundDown(near)), std::floor(near)) << near;
      }
    }
  }
}

}  // namespace
}  // namespace graspdb::recognition
