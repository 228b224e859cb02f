// The backward correction of a loop of 60 poses, as long as that of experiment 2 of the thesis,
// with 40 candidates for the last pose.
#include <cstdint>

#include <benchmark/benchmark.h>

#include "topogeo/thesis/backward_correction.hpp"

#include "thesis/backward_problems.hpp"

namespace {

using namespace topogeo::localization;

void backward(benchmark::State& state) {
  test::LoopOptions options;
  options.poses = static_cast<std::uint32_t>(state.range(0));
  const test::Loop loop = test::circle(options, 1);
  BackwardResult result;
  for (auto _ : state) {
    result = correct_backward(loop.problem, loop.solutions);
    benchmark::DoNotOptimize(result);
  }
  if (result.outcome != LoopSearchOutcome::kClosed) state.SkipWithError("the loop stayed open");
  state.counters["expanded"] = static_cast<double>(result.expanded);
}

BENCHMARK(backward)->Name("backward")->Arg(60)->Arg(120)->Unit(benchmark::kMillisecond);

}  // namespace
