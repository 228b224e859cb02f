// Accuracy of matches of two local maps, and whether their verdicts can be trusted.
//
//   topogeo_match_quality [--world FILE]... [--log FILE --reference FILE.tum]... [--config FILE]
//
// First table: pairs of stops i,i+1 and i,i+3 against their true relative pose, by odometry, by the
// scan tracker and by matching with every form of the fitness. Second table: how well matches of
// three stops agree with each other, which bounds the accuracy of the references. Third table:
// pairs of stops with a false prediction that do not overlap, or look the same a few metres on: the
// wrong matches that are accepted, beside the matches kept of pairs that do overlap. matching.sh
// names the inputs.
#include <cstdio>
#include <exception>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/config.hpp"

#include "matching_accuracy.hpp"
#include "matching_look_alikes.hpp"
#include "matching_run.hpp"

namespace {

using namespace topogeo;

struct Options {
  std::vector<std::string> worlds;
  std::vector<std::string> logs;
  std::vector<std::string> references;
  std::string config_file;
  std::string samples_file;
  bool quick = false;
  bool accuracy = true;
  bool look_alikes = true;
};

void progress(const std::string& name, const char* work) {
  std::fprintf(stderr, "topogeo_match_quality: %s: %s\n", name.c_str(), work);
}

std::vector<bench::MatchingRun> load(const Options& options, const pipeline::Config& config) {
  std::vector<bench::MatchingRun> runs;
  for (const std::string& world : options.worlds) {
    progress(world, "local maps");
    runs.emplace_back(bench::simulated(world), config);
  }
  for (std::size_t i = 0; i < options.logs.size(); ++i) {
    progress(options.logs[i], "local maps");
    runs.emplace_back(bench::recorded(options.logs[i], options.references[i], config.log), config);
  }
  return runs;
}

void print_tables(const Options& options, std::vector<bench::MatchingRun>& runs) {
  if (options.accuracy) {
    const std::size_t most = options.quick ? 60 : std::numeric_limits<std::size_t>::max();
    bench::print_accuracy_header(stdout);
    for (bench::MatchingRun& run : runs) {
      for (const std::size_t apart : {1U, 3U}) {
        progress(run.name(), apart == 1 ? "pairs i,i+1" : "pairs i,i+3");
        bench::print_accuracy(stdout, run, apart, most);
      }
    }
    std::fputs("\n", stdout);
    bench::print_closure_header(stdout);
    for (bench::MatchingRun& run : runs) {
      progress(run.name(), "closing of three stops");
      bench::print_closure(stdout, run, most);
    }
    std::fputs("\n", stdout);
  }
  if (!options.look_alikes) return;
  bench::LookAlikes look_alikes(options.quick ? 40 : 300, options.samples_file);
  for (bench::MatchingRun& run : runs) {
    progress(run.name(), "look-alikes");
    look_alikes.add(run);
  }
  look_alikes.print(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app{"how right matches of two local maps are"};
  Options options;
  app.add_option("--world", options.worlds, "world file to simulate a log in");
  app.add_option("--log", options.logs, "CARMEN log");
  app.add_option("--reference", options.references, "reference trajectory of each log, TUM");
  app.add_option("--config", options.config_file, "configuration file")
      ->check(command_line::existing_file());
  app.add_option("--samples", options.samples_file,
                 "write every match of the third table, with its evidence, to this CSV file");
  app.add_flag("--quick", options.quick, "a small sample of the pairs");
  app.add_flag("--accuracy,!--no-accuracy", options.accuracy, "print the first two tables");
  app.add_flag("--look-alikes,!--no-look-alikes", options.look_alikes, "print the third table");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  if (options.logs.size() != options.references.size()) {
    std::fprintf(stderr, "topogeo_match_quality: every --log needs a --reference\n");
    return 2;
  }
  try {
    const auto file = options.config_file.empty()
                          ? std::nullopt
                          : std::optional<std::filesystem::path>(options.config_file);
    const pipeline::Config config = pipeline::load_config(file).config;
    std::vector<bench::MatchingRun> runs = load(options, config);
    print_tables(options, runs);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_match_quality: %s\n", error.what());
    return 1;
  }
  return 0;
}
