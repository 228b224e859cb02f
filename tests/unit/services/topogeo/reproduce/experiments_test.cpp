// Runs every experiment that needs no drive, compares its measurements with the publication, and
// checks its row on the page and in its JSON.
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "topogeo/support/temporary_folder.hpp"

#include "reproduce/experiment.hpp"
#include "reproduce/index_page.hpp"
#include "reproduce/shared_runs.hpp"
#include "reproduce/worlds.hpp"

namespace topogeo::reproduce {
namespace {

const Experiment& experiment_named(const std::string& name) {
  const auto at = std::ranges::find(experiments(), name, &Experiment::name);
  if (at == experiments().end()) throw std::invalid_argument("no experiment " + name);
  return *at;
}

/// Each experiment runs once for all tests, because it depends on its name alone.
class ExperimentRuns : public testing::Test {
 protected:
  static void SetUpTestSuite() { done_ = std::make_unique<Done>(); }
  static void TearDownTestSuite() { done_.reset(); }

  static const Outcome& run(const std::string& name) {
    auto found = done_->outcomes.find(name);
    if (found == done_->outcomes.end()) {
      Outcome outcome = run_experiment(experiment_named(name), done_->folder.path(), done_->runs);
      found = done_->outcomes.emplace(name, std::move(outcome)).first;
    }
    return found->second;
  }
  static const std::filesystem::path& folder() { return done_->folder.path(); }
  static SharedRuns& runs() { return done_->runs; }

 private:
  struct Done {
    support::TemporaryFolder folder{"reproduce"};
    SharedRuns runs;
    std::map<std::string, Outcome> outcomes;
  };
  static std::unique_ptr<Done> done_;
};

std::unique_ptr<ExperimentRuns::Done> ExperimentRuns::done_;

TEST(Experiments, HaveNamesOfTheirOwnAndSayWhatTheyShow) {
  std::set<std::string> names;
  for (const Experiment& experiment : experiments()) {
    EXPECT_TRUE(names.insert(experiment.name).second) << experiment.name;
    EXPECT_FALSE(experiment.caption.empty()) << experiment.name;
    EXPECT_FALSE(experiment.number.empty()) << experiment.name;
    EXPECT_NE(experiment.run, nullptr) << experiment.name;
  }
}

TEST(Experiments, ScenesOfTheFiguresAreCompiledIn) {
  EXPECT_TRUE(has_world("figure_4_08"));
  EXPECT_FALSE(has_world("figure_9_99"));
  EXPECT_THROW(static_cast<void>(world_named("figure_9_99")), std::invalid_argument);
  EXPECT_FALSE(world_named("figure_5_07").segments.empty());
}

void expect_compares(const Outcome& outcome, const std::filesystem::path& folder) {
  const std::string& name = outcome.experiment->name;
  EXPECT_EQ(outcome.failure, "") << name;
  EXPECT_TRUE(std::ranges::any_of(outcome.values,
                                  [](const Value& value) {
                                    return value.relation != Relation::kShown &&
                                           value.expected.has_value();
                                  }))
      << name << " compares nothing";
  for (const ReportPicture& picture : outcome.pictures) {
    EXPECT_TRUE(std::filesystem::is_regular_file(folder / picture.file)) << picture.file;
  }
}

TEST_F(ExperimentRuns, LightOnesCompareAndDraw) {
  for (const Experiment& experiment : experiments()) {
    if (!experiment.drives) expect_compares(run(experiment.name), folder());
  }
}

TEST_F(ExperimentRuns, DrivesCompareAndDraw) {
  for (const Experiment& experiment : experiments()) {
    if (experiment.drives) expect_compares(run(experiment.name), folder());
  }
}

// Exact published values are reproduced exactly.
TEST_F(ExperimentRuns, TablesAndMatricesAgree) {
  for (const std::string name :
       {"table-4.1", "table-6.1", "table-6.2", "table-6.4", "macondo-figure-4", "macondo-figure-6",
        "macondo-figure-7", "macondo-figure-8"}) {
    const Outcome& outcome = run(name);
    EXPECT_EQ(outcome.verdict(), Verdict::kEqual) << name << ": " << outcome.verdict_text();
  }
}

// The rules of chapters 4 and 5 are reproduced without differences, except for times.
TEST_F(ExperimentRuns, FiguresOfScenesAgree) {
  for (const Experiment& experiment : experiments()) {
    const bool scene = experiment.number.find(" 4.") != std::string::npos ||
                       experiment.number.find(" 5.") != std::string::npos;
    if (!scene || experiment.name == "figure-4.18") continue;
    const Outcome& outcome = run(experiment.name);
    EXPECT_NE(outcome.verdict(), Verdict::kDiffers)
        << experiment.name << ": " << outcome.verdict_text();
  }
}

TEST_F(ExperimentRuns, ThePageAndItsJsonHaveARowOfEach) {
  const std::vector<Outcome> outcomes{run("figure-4.10"), run("table-4.1")};
  const auto json = nlohmann::json::parse(index_json(outcomes));
  ASSERT_EQ(json["experiments"].size(), 2U);
  const auto& row = json["experiments"][0];
  EXPECT_EQ(row["name"], "figure-4.10");
  EXPECT_EQ(row["number"], "Figure 4.10");
  EXPECT_EQ(row["verdict"], "equal");
  EXPECT_EQ(row["pictures"][0]["file"], "pictures/figure-4.10.png");
  EXPECT_EQ(row["values"][0]["measured"], 6.0);
  EXPECT_EQ(row["values"][0]["expected"], 6.0);
  const std::string page = index_page(outcomes);
  EXPECT_THAT(page, testing::HasSubstr("id=\"table-4.1\""));
  EXPECT_THAT(page, testing::HasSubstr("src=\"pictures/figure-4.10.png\""));
}

TEST_F(ExperimentRuns, AFailureIsARowOfItsOwn) {
  const Experiment failing{.name = "failing",
                           .publication = "Thesis",
                           .number = "Figure 0",
                           .caption = "nothing",
                           .run = [](Report&) { throw std::runtime_error("<no laser>"); }};
  const Outcome outcome = run_experiment(failing, folder(), runs());
  EXPECT_EQ(outcome.verdict(), Verdict::kDiffers);
  EXPECT_EQ(outcome.verdict_text(), "differs because it failed: <no laser>");
  EXPECT_THAT(index_page({outcome}), testing::HasSubstr("&lt;no laser&gt;"));
}

}  // namespace
}  // namespace topogeo::reproduce
