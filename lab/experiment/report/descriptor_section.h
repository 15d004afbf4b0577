// Descriptors side by side, after figure 12 of the paper.
#pragma once

#include <string>
#include <vector>

#include "lab/experiment/descriptor_figures.h"

namespace graspdb::client {

// A <section> with a table (descriptors by distances, mean over the objects) and bars for each
// object: every descriptor with the first distance that it comes with. Empty without figures.
std::string DescriptorSection(const std::vector<DescriptorFigures>& figures);

}  // namespace graspdb::client
