// Random numbers that are a function of (seed, stream, counter), not of history: the same on every
// machine and in every order of evaluation. The sequences of <random>'s distributions are
// implementation-defined.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace graspdb::rendering {

// The finaliser of SplitMix64.
constexpr std::uint64_t MixBits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

constexpr std::uint64_t RandomBits(std::uint64_t seed, std::uint64_t stream,
                                   std::uint64_t counter) {
  return MixBits(MixBits(MixBits(seed) ^ stream) ^ counter);
}

// In [0, 1).
constexpr double RandomUniform(std::uint64_t seed, std::uint64_t stream, std::uint64_t counter) {
  return static_cast<double>(RandomBits(seed, stream, counter) >> 11) * 0x1p-53;
}

// Mean 0, standard deviation 1 (Box and Muller, 1958).
inline double RandomGaussian(std::uint64_t seed, std::uint64_t stream, std::uint64_t counter) {
  const double u = 1 - RandomUniform(seed, stream, 2 * counter);  // in (0, 1]
  const double v = RandomUniform(seed, stream, 2 * counter + 1);
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

}  // namespace graspdb::rendering
