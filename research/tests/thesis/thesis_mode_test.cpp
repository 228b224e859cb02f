#include "topogeo/thesis/thesis_mode.hpp"

#include <gtest/gtest.h>

#include "topogeo/matching/fitness_forms.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/session/slam_session.hpp"
#include "topogeo/support/config_schema.hpp"
#include "topogeo/thesis/thesis_slam.hpp"

namespace topogeo::localization {
namespace {

TEST(ThesisMode, IsPartOfEachProgram) {
  InProcessPool pool;
  LocalizerConfig config;
  config.mode = SlamAlgorithm::kThesis;
  EXPECT_NE(dynamic_cast<ThesisSlam*>(make_slam(config, pool).get()), nullptr);
  EXPECT_EQ(fitness_forms().size(), 4U);
}

TEST(ThesisMode, CopiesOfAConfigurationHaveTheirOwnSettings) {
  LocalizerConfig first;
  support::ConfigSchema schema;
  describe(first, schema);
  const LocalizerConfig second = first;
  support::load_yaml_text("thesis: {kept_solutions: 7}\nbackward: {beam_width: 9}\n", "a.yaml",
                          schema);
  const LocalizerConfig third = first;
  EXPECT_EQ(thesis_config(first).thesis.kept_solutions, 7U);
  EXPECT_EQ(thesis_config(second).thesis.kept_solutions, 0U);
  EXPECT_EQ(thesis_config(third).thesis.kept_solutions, 7U);
  EXPECT_EQ(thesis_config(third).thesis.backward.beam_width, 9U);
}

}  // namespace
}  // namespace topogeo::localization
