// Optimises in a thread of its own, so that stops and live poses are processed meanwhile.
#pragma once

#include <future>
#include <stdexcept>
#include <utility>

#include "topogeo/slam/graph_optimization.hpp"

namespace topogeo::localizer {

class BackgroundOptimizer : public localization::GraphOptimizer {
 public:
  void start(localization::GraphProblem problem) override {
    if (job_.valid()) throw std::logic_error("optimizer: the previous job was not fetched");
    job_ = std::async(std::launch::async,
                      [problem = std::move(problem)] { return localization::solve(problem); });
  }
  localization::GraphSolution fetch() override {
    if (!job_.valid()) throw std::logic_error("optimizer: no job was started");
    return job_.get();
  }

 private:
  std::future<localization::GraphSolution> job_;  // the destructor waits for its end
};

}  // namespace topogeo::localizer
