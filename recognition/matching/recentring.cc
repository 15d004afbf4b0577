#include "recognition/matching/recentring.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace graspdb::recognition {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;

// Standard deviation of a residual of weight 1, m. Errors of points are correlated, so that it is
// several times that of one point. Chosen; not measured alone. Doubled, so is the deviation of each
// axis: more of them exceed kFirmM, and the refined pose has a quarter of its weight against the
// middle; without any weight well constrained poses get worse (ADR 19).
constexpr double kDeviationM = 0.0066;
// Axes with a smaller deviation are firmly constrained, m. Chosen; not measured alone. Doubled,
// poses with a deviation of 0.6 to 1.2 mm keep their errors and save the verifications.
constexpr double kFirmM = 0.0006;
// Steps along the direction, m at the model's rim, and how many there are at most to each side.
// Chosen; ten to twenty verifications an object (ADR 19). Steps of twice the length find the middle
// less exactly; twice as many reach 20 mm, with up to twice the verifications.
constexpr double kStepM = 0.001;
constexpr int kMaxSteps = 10;
// Scores (0 to 1) are better from kBetter more on; poses are as good up to kAsGood below the best
// score. Chosen (ADR 19); not measured alone. Doubled, the first ends the climb on flatter slopes;
// the second widens the range, and thereby lowers the weight of its middle.
constexpr double kBetter = 3e-4;
constexpr double kAsGood = 2e-3;

// The weakest axis: a turn about the model's center and a move, world frame, per metre at the
// model's rim.
struct Direction {
  Vector6d motion = Vector6d::Zero();
  double deviation_m = 0;
};

Direction WeakestDirection(const SurfaceModel& model, const InformationMatrix& information) {
  Vector6d scale = Vector6d::Ones();
  // A single point has no rim.
  scale.head<3>() /= std::max(static_cast<double>(model.radius_m), kStepM);
  const Eigen::SelfAdjointEigenSolver<InformationMatrix> solver(scale.asDiagonal() * information *
                                                                scale.asDiagonal());
  const double smallest = std::max(solver.eigenvalues()[0], 1e-6);
  return {scale.asDiagonal() * solver.eigenvectors().col(0), kDeviationM / std::sqrt(smallest)};
}

// Poses along a direction, m from the first one.
class Line {
 public:
  Line(const SurfaceModel& model, const Recentred& begin, const Vector6d& motion,
       const Judge& judge)
      : center_(begin.world_object * model.center.cast<double>()),
        begin_(begin),
        motion_(motion),
        judge_(judge) {}

  Recentred At(double along_m) const {
    Recentred out = {Moved(begin_.world_object, center_, along_m * motion_), {}};
    out.evidence = judge_(out.world_object);
    return out;
  }
  double ScoreAt(double along_m) const { return At(along_m).evidence.score; }

  // Climbs from the first pose while steps to either side lead to better scores.
  double Top(double* score) const {
    double top = 0;
    *score = begin_.evidence.score;
    for (const double step : {kStepM, -kStepM}) {
      for (int n = 0; n < kMaxSteps; ++n) {
        const double next = ScoreAt(top + step);
        if (next <= *score + kBetter) break;
        top += step;
        *score = next;
      }
      if (top != 0) break;
    }
    return top;
  }

  // Distance from `top` up to which scores are as good, in steps of `step`.
  double End(double top, double top_score, double step) const {
    const double min_score = top_score - kAsGood;
    double last = top_score;
    for (int n = 0; n < kMaxSteps; ++n) {
      const double next = ScoreAt(top + (n + 1) * step);
      if (next < min_score) return (n + (last - min_score) / (last - next)) * step;
      last = next;
    }
    return kMaxSteps * step;
  }

 private:
  Eigen::Vector3d center_;
  const Recentred& begin_;
  const Vector6d& motion_;
  const Judge& judge_;
};

}  // namespace

Recentred Recentre(const SurfaceModel& model, const Recentred& refined,
                   const InformationMatrix& information, const Judge& judge) {
  const Direction direction = WeakestDirection(model, information);
  if (direction.deviation_m < kFirmM) return refined;
  const Line line(model, refined, direction.motion, judge);
  double score = 0;
  const double top = line.Top(&score);
  const double low = line.End(top, score, -kStepM);
  const double high = line.End(top, score, kStepM);
  const double spread = (high - low) / 2;
  const double middle = top + (low + high) / 2;
  // The mean of that and of 0, the refined pose, weighted by their variances.
  const double variance = direction.deviation_m * direction.deviation_m;
  return line.At(middle * variance / (variance + spread * spread));
}

}  // namespace graspdb::recognition
