// The parts of chapter 7.
#pragma once

#include <vector>

#include "reproduce/experiment.hpp"

namespace topogeo::reproduce {

std::vector<Experiment> chapter7_forward();
std::vector<Experiment> chapter7_backward();
std::vector<Experiment> chapter7_fusion();

}  // namespace topogeo::reproduce
