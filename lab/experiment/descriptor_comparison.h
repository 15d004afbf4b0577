// The paper's experiment on descriptors alone: no alignment, no verification.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lab/experiment/experiment_run.h"
#include "lab/experiment/trials/cases.h"

namespace graspdb::lab {

// Results of the nearest view by one descriptor and one distance.
struct DescriptorFigures {
  std::string descriptor;  // one of DescriptorNames()
  std::string distance;    // display name, e.g. "chi-square"
  // How often the nearest of the object's own views is from a viewpoint more than 15 degrees off,
  // modulo its symmetry: the paper's false recognition of mirrored poses (figure 12). By object id;
  // share of its queries, 0 to 1.
  std::map<std::string, double> false_recognition = {};
  double object_wrong = 0;      // share of all queries whose nearest view is of another object
  std::size_t query_count = 0;  // number of queries
};

// Every object counts the same.
double MeanFalseRecognition(const DescriptorFigures& figures);

// Every descriptor with every distance over `trials`, which show one object at a time. Objects that
// are not taught are left out. Descriptors in the order of DescriptorNames(); distances chi-square,
// Hellinger, L1, L2. Errors as RunCase.
absl::StatusOr<std::vector<DescriptorFigures>> CompareDescriptors(const PartSet& set,
                                                                  const ExperimentTrials& trials,
                                                                  const ExperimentRun& run);

}  // namespace graspdb::lab
