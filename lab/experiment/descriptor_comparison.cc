#include "lab/experiment/descriptor_comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/status_macros.h"
#include "lab/experiment/trials/trial.h"

namespace graspdb::lab {
namespace {

using recognition::Descriptor;

constexpr double kFalseRad = 15.5 * std::numbers::pi / 180;
// Terms that are summed over the bins; the sums are ordered like the distances.
double Hellinger(float a, float b) {
  const double d = std::sqrt(static_cast<double>(a)) - std::sqrt(static_cast<double>(b));
  return d * d;
}
double L1(float a, float b) { return std::abs(static_cast<double>(a) - static_cast<double>(b)); }
double L2(float a, float b) {
  const double d = static_cast<double>(a) - static_cast<double>(b);
  return d * d;
}
double ChiSquare(float a, float b) {
  const double sum = static_cast<double>(a) + static_cast<double>(b);
  return sum > 0 ? L2(a, b) / sum : 0;
}

struct Distance {
  const char* name;
  double (*term)(float, float);
};
constexpr std::array<Distance, 4> kDistances = {
    {{"chi-square", ChiSquare}, {"Hellinger", Hellinger}, {"L1", L1}, {"L2", L2}}};

// Visible points of a part.
struct Sample {
  std::size_t part = 0;
  double azimuth_rad = 0;
  bool posed = true;                    // the azimuth is known
  std::vector<Descriptor> descriptors;  // by DescriptorNames()
};

absl::StatusOr<Sample> SampleOf(const Trial& trial, const ExperimentRun& run) {
  ASSIGN_OR_RETURN(const auto shown, SegmentShown(trial, run.parameters));
  const rendering::Placement& truth = trial.truth.front();
  Sample out{.part = truth.part, .posed = trial.posed, .descriptors = {}};
  const Eigen::Vector3d x = truth.world_object.linear().col(0);
  out.azimuth_rad = std::atan2(x.y(), x.x());
  for (const std::string& name : recognition::DescriptorNames()) {
    ASSIGN_OR_RETURN(auto descriptor,
                     recognition::Describe(shown.segment.cloud, shown.world_sensor,
                                           *recognition::DescriptorFromName(name)));
    out.descriptors.push_back(std::move(descriptor));
  }
  return out;
}

absl::StatusOr<std::vector<Sample>> Samples(const TrialSource& trials, const std::string& step,
                                            const ExperimentRun& run) {
  std::vector<Sample> out(trials.count);
  absl::Status status = ForEach(trials.count, step, run, [&](std::size_t i) -> absl::Status {
    ASSIGN_OR_RETURN(const auto trial, trials.make(i));
    ASSIGN_OR_RETURN(auto sample, SampleOf(trial, run));
    out[i] = std::move(sample);
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return out;
}

double DistanceOf(const Sample& a, const Sample& b, std::size_t kind, const Distance& distance) {
  double sum = 0;
  const Descriptor& of_b = b.descriptors[kind];
  const Descriptor& of_a = a.descriptors[kind];
  for (std::size_t i = 0; i < of_a.size(); ++i) sum += distance.term(of_a[i], of_b[i]);
  return sum;
}

// More than 15 degrees apart, modulo symmetric turns.
bool IsFalse(const Sample& query, const Sample& view, const PartSet& set) {
  const rendering::Workpiece& part = set.parts[query.part];
  const rendering::MeasuredShape* shape = set.shapes[query.part].get();
  if (shape == nullptr ? part.symmetry_order == 0 : shape->any_turn) return false;
  const std::vector<double> turns =
      shape == nullptr ? rendering::TurnsOf(part.symmetry_order) : shape->turns_rad;
  return std::ranges::all_of(turns, [&](double turn) {
    const double apart =
        std::remainder(query.azimuth_rad - view.azimuth_rad - turn, 2 * std::numbers::pi);
    return std::abs(apart) > kFalseRad;
  });
}

// The views nearest to a query.
struct NearestSamples {
  const Sample* own = nullptr;
  double own_distance = 1e9;
  double other_distance = 1e9;
};

NearestSamples NearestTo(const Sample& query, const std::vector<Sample>& views,
                         const Sample* left_out, std::size_t kind, const Distance& distance) {
  NearestSamples out;
  for (const Sample& view : views) {
    if (&view == left_out) continue;
    const double d = DistanceOf(query, view, kind, distance);
    if (view.part != query.part) {
      out.other_distance = std::min(out.other_distance, d);
    } else if (d < out.own_distance) {
      out.own_distance = d;
      out.own = &view;
    }
  }
  return out;
}

DescriptorFigures Figures(const std::vector<Sample>& views, const std::vector<Sample>& queries,
                          bool leave_one_out, std::size_t kind, const Distance& distance,
                          const PartSet& set) {
  DescriptorFigures out{.descriptor = recognition::DescriptorNames()[kind],
                        .distance = distance.name};
  std::map<std::string, double> query_counts;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Sample& query = queries[i];
    if (query.part >= set.taught_count) continue;
    const NearestSamples nearest =
        NearestTo(query, views, leave_one_out ? &views[i] : nullptr, kind, distance);
    ++out.query_count;
    out.object_wrong += nearest.other_distance < nearest.own_distance;
    if (!query.posed || (nearest.own != nullptr && !nearest.own->posed)) continue;
    const std::string& object = set.parts[query.part].object_id;
    query_counts[object] += 1;
    out.false_recognition[object] += nearest.own == nullptr || IsFalse(query, *nearest.own, set);
  }
  for (auto& [object, share] : out.false_recognition) share /= query_counts[object];
  out.object_wrong /= std::max(1.0, static_cast<double>(out.query_count));
  return out;
}

}  // namespace

double MeanFalseRecognition(const DescriptorFigures& figures) {
  double sum = 0;
  for (const auto& [object, share] : figures.false_recognition) sum += share;
  return sum / std::max(1.0, static_cast<double>(figures.false_recognition.size()));
}

absl::StatusOr<std::vector<DescriptorFigures>> CompareDescriptors(const PartSet& set,
                                                                  const ExperimentTrials& trials,
                                                                  const ExperimentRun& run) {
  const auto views = Samples(trials.teaching, "descriptors: teaching", run);
  if (!views.ok()) return views.status();
  ASSIGN_OR_RETURN(const auto queries, trials.leave_one_out
                                           ? views
                                           : Samples(trials.queries, "descriptors: queries", run));
  std::vector<DescriptorFigures> out(recognition::DescriptorNames().size() * kDistances.size());
  absl::Status compared = ForEach(out.size(), "descriptors: comparing", run, [&](std::size_t i) {
    out[i] = Figures(*views, queries, trials.leave_one_out, i / kDistances.size(),
                     kDistances[i % kDistances.size()], set);
    return absl::OkStatus();
  });
  if (!compared.ok()) return compared;
  return out;
}

}  // namespace graspdb::lab
