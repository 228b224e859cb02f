// topogeo reproduce: makes the figures and tables of the publications and compares them with the
// published ones.
#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"

#include "commands.hpp"
#include "reproduce/experiment.hpp"
#include "reproduce/index_page.hpp"
#include "reproduce/shared_runs.hpp"

namespace topogeo::cli {
namespace {

struct ReproduceOptions {
  std::vector<std::string> names;
  std::filesystem::path out;
  bool list = false;
  bool json = false;
};

void print_experiments_json() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const reproduce::Experiment& experiment : reproduce::experiments()) {
    list.push_back({{"name", experiment.name},
                    {"publication", experiment.publication},
                    {"number", experiment.number},
                    {"caption", experiment.caption}});
  }
  std::cout << list.dump(2) << '\n';
}

std::vector<std::string> names_of_experiments() {
  std::vector<std::string> names = {"all"};
  for (const reproduce::Experiment& one : reproduce::experiments()) names.emplace_back(one.name);
  return names;
}

void print_experiments() {
  for (const reproduce::Experiment& experiment : reproduce::experiments()) {
    std::cout << fmt::format("{:<22} {}, {}: {}\n", experiment.name, experiment.publication,
                             experiment.number, experiment.caption);
  }
}

std::vector<const reproduce::Experiment*> chosen_experiments(
    const std::vector<std::string>& names) {
  const std::vector<reproduce::Experiment>& all = reproduce::experiments();
  std::vector<const reproduce::Experiment*> chosen;
  for (const std::string& name : names) {
    const std::size_t before = chosen.size();
    for (const reproduce::Experiment& experiment : all) {
      const bool wanted =
          name == "all" || name == experiment.name ||
          (name.ends_with('*') && experiment.name.starts_with(name.substr(0, name.size() - 1)));
      if (wanted && std::ranges::find(chosen, &experiment) == chosen.end()) {
        chosen.push_back(&experiment);
      }
    }
    if (chosen.size() == before) {
      throw service::UsageError("no experiment '" + name + "'; --list prints their names");
    }
  }
  return chosen;
}

int reproduce_all(const ReproduceOptions& options) {
  if (options.list) {
    options.json ? print_experiments_json() : print_experiments();
    return service::kOk;
  }
  if (options.names.empty() || options.out.empty()) {
    throw service::UsageError("expected NAME or all, and --out DIR, or --list");
  }
  const std::vector<const reproduce::Experiment*> chosen = chosen_experiments(options.names);
  std::filesystem::create_directories(options.out / "pictures");
  support::check_writable_directory(options.out);
  reproduce::SharedRuns runs;
  std::vector<reproduce::Outcome> outcomes;
  for (const reproduce::Experiment* experiment : chosen) {
    outcomes.push_back(reproduce::run_experiment(*experiment, options.out / "pictures", runs));
    const reproduce::Outcome& outcome = outcomes.back();
    std::cout << fmt::format("[{}/{}] {}: {} ({:.1f} s)\n", outcomes.size(), chosen.size(),
                             experiment->name, outcome.verdict_text(), outcome.wall_s)
              << std::flush;
  }
  support::write_file_atomically(options.out / "index.json", reproduce::index_json(outcomes));
  support::write_file_atomically(options.out / "index.html", reproduce::index_page(outcomes));
  const bool failed = std::ranges::any_of(
      outcomes, [](const reproduce::Outcome& outcome) { return !outcome.failure.empty(); });
  std::cout << (options.out / "index.html").string() << '\n';
  return failed ? service::kFailure : service::kOk;
}

}  // namespace

void add_reproduce_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command = app.add_subcommand(
      "reproduce", "Make the figures and tables of the publications, beside what is published");
  auto options = std::make_shared<ReproduceOptions>();
  command
      ->add_option("names", options->names,
                   "all, names of experiments, or the beginning of names followed by *")
      ->completed_by(names_of_experiments())
      ->type_name("NAME");
  command->add_option("--out", options->out, "directory for the results")->type_name("DIR");
  command_line::Option* const list =
      command->add_flag("--list", options->list, "print the names of all experiments");
  command->add_flag("--json", options->json, "for programs: the list as JSON")->needs(list);
  command->footer(
      "DIR/index.html shows each figure or table made here beside the published values, with a\n"
      "verdict that is computed from them; DIR/index.json has the same for programs. The worlds\n"
      "are part of the program. A verdict of 'differs' is a result, an experiment that cannot be\n"
      "run is a failure (exit code 1).");
  command->callback([options, &exit_code] { exit_code = reproduce_all(*options); });
}

}  // namespace topogeo::cli
