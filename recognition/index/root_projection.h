// Roots of histograms in few dimensions.
#pragma once

#include <memory>
#include <span>
#include <vector>

namespace graspdb::recognition {

// An orthonormal projection of the roots of histograms onto their principal components. The
// distance of two projections is never larger than that of the roots (Bessel's inequality),
// whatever the projection was fitted to: the fit determines how much of the distance remains.
//
// The components are turned by a Hadamard matrix, so that all have the same variance and rounding
// them in equal steps loses the least. Immutable; safe for concurrent reads.
class RootProjection {
 public:
  // Bytes a view in the first pass of a search. 64 take twice the memory traffic and leave half as
  // many views to be measured, which is slower for 10 neighbours and as fast for 600; 16 leave
  // three times as many. A power of two, for the Hadamard matrix.
  static constexpr std::size_t kComponents = 32;

  // Fits to a sample of roots, all of one size; some 50 ms for 2,000 of 288. Null where the
  // components would keep too little of the variance for bounds to be of use, and for fewer rows or
  // bins than components, or numbers that are not finite.
  static std::shared_ptr<const RootProjection> Fit(const std::vector<std::vector<float>>& sample);

  std::size_t bins() const { return means_.size(); }

  struct Projection {
    std::vector<float> components;
    float rounding = 0;  // upper bound of their floating-point error
  };

  // Of `roots`, which have as many values as those of the sample; some 5 microseconds for 288.
  Projection Project(std::span<const float> roots) const;

 private:
  RootProjection(std::span<const float> means, std::span<const float> axes)
      : means_(means.begin(), means.end()), axes_(axes.begin(), axes.end()) {}

  const std::vector<float> means_;  // of the sample, one a bin
  const std::vector<float> axes_;   // kComponents values for each bin
};

}  // namespace graspdb::recognition
