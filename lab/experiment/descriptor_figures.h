// What a descriptor alone recognises.
#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace graspdb::client {

// What the nearest view by one descriptor and one distance shows.
struct DescriptorFigures {
  std::string descriptor;  // as it is shown, e.g. "MVFH-300"
  std::string distance;    // as it is shown, e.g. "chi-square"
  // How often the nearest of the object's own views was taken from a side that is more than 15
  // degrees off, modulo its symmetry: the paper's false recognition of mirrored poses (figure
  // 12). By object id; share of its questions, 0 to 1.
  std::map<std::string, double> false_recognition = {};
  double object_wrong = 0;  // share of all questions whose nearest view is another object's
  std::size_t asked = 0;    // questions in all
};

// Every object counts the same.
double MeanFalseRecognition(const DescriptorFigures& figures);

}  // namespace graspdb::client
