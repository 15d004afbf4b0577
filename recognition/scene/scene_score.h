// How sure a hypothesis is, by what the frame says about it.
#pragma once

#include "recognition/frame/frame.h"
#include "recognition/scene/object_search.h"

namespace graspdb::recognition {

// Weights of what counts against a hypothesis, per unit of its feature. Set by hand, then moved by
// a logistic regression that was held near them, over the hypotheses in 40 real frames with 60
// posed objects and 18 frames of other objects (docs/adr/0033).
struct SceneScoreWeights {
  float offset = 2.1F;
  // Shares of the measured surface, beyond what a camera's own faults contradict.
  float behind = 6.0F;  // where the camera looked through it
  float tilted = 5.4F;  // where a surface of another direction is
  float table = 1.8F;   // where only the table is
  float bend = 13.0F;   // mean of 1 - cosine between the normals
  // Shares of the visible surface.
  float unmeasured = 1.5F;
  float covered = 8.0F;  // by something close in front: the scene goes through the model
  float hidden = 1.1F;   // by something else
  float unseen = 1.2F;   // the logarithm of 0.7 / the seen share
  // Shares of the outline.
  float smooth = 10.0F;         // where the scene goes on as if nothing ended
  float unknown = 1.8F;         // that is hidden or not measured
  float little_outline = 1.0F;  // the logarithm of 20 / the known points of the outline
  float residual = 2.3F;        // root mean square distance beyond 0.3 tolerances
  float floating = 3.3F;        // 5 cm above the table
  float sunk = 3.6F;            // 3 cm below it
  float information = 0.8F;     // the logarithm of 0.6 / SceneHypothesis::information
  float area = 2.8F;            // the logarithm of 40 cm2 / the seen area
};

// Only what contradicts a pose, for an answer whose own confidence already counts how little was
// seen of it. Set by hand. Normals over 10 mm blur studs and thin parts, so that they count less.
inline constexpr SceneScoreWeights kContradictions = {.offset = 0,
                                                      .behind = 7,
                                                      .tilted = 3,
                                                      .table = 4,
                                                      .bend = 5,
                                                      .unmeasured = 0,
                                                      .covered = 2,
                                                      .hidden = 0,
                                                      .unseen = 0,
                                                      .smooth = 8,
                                                      .unknown = 0,
                                                      .little_outline = 0,
                                                      .residual = 0,
                                                      .floating = 2,
                                                      .sunk = 4,
                                                      .information = 0,
                                                      .area = 0};

// The log-odds that the hypothesis is right. Above 0, more are right than wrong on the frames that
// the weights were fitted on.
float SceneScore(const Frame& frame, const SceneHypothesis& hypothesis,
                 const ImageEvidenceParameters& parameters, const SceneScoreWeights& weights = {});

// A pose without a rival has this one, log-odds.
inline constexpr float kNoRivalLogOdds = -6;

// A logistic regression over the 590 proposals with a score of their own points of at least 0.5 in
// 160 composites, but for the offset: that of the regression, -1.6, accepts unknown objects that
// resemble taught ones too often (docs/adr/0034).
struct ProposalWeights {
  double offset = -2.4;
  double image = 0.87;  // of SceneScore
  double lead = 0.38;   // before the best other pose in its place, log-odds, up to max_lead
  double area = 0.88;   // the logarithm of the seen area / 40 cm2
  double min_lead = -1;
  double max_lead = 3;
};

// How sure a proposal of the search is, 0 to 1, by the image and the other proposals.
double ProposalScore(float log_odds, float lead, float seen_area_m2,
                     const ProposalWeights& weights);

}  // namespace graspdb::recognition
