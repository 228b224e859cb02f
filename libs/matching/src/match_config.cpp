#include "topogeo/matching/match_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::localization {

void describe(GeneticParameters& parameters, support::ConfigSchema& schema) {
  schema.add("match.individuals", &parameters.individuals, 4U, 10000U, "",
             "population of the genetic search");
  schema.add("match.generations", &parameters.generations, 1U, 10000U, "",
             "generations of the genetic search; 50 individuals x 30 generations with refinement "
             "are as good as the 100 x 50 of the thesis");
  schema.add("match.crossover_rate", &parameters.crossover_rate, 0.0, 1.0, "",
             "probability that two parents exchange genes");
  schema.add("match.mutation_rate", &parameters.mutation_rate, 0.0, 0.5, "",
             "probability of a mutation for each bit");
  schema.add("match.elite", &parameters.elite, 1U, 100U, "",
             "best individuals that survive unchanged");
  schema.add("match.branch_hypotheses", &parameters.branch_hypotheses, 0U, 1000U, "",
             "most initial individuals that place a branch or node on an equivalent one");
  schema.add("match.resolution_m", &parameters.resolution_m, 0.005, 2.0, "m",
             "resolution of the position genes");
  schema.add("match.resolution_rad", &parameters.resolution_rad, 0.001, 0.5, "rad",
             "resolution of the heading gene");
  schema.add("match.finer_resolution_m", &parameters.finer_resolution_m, 0.0, 2.0, "m",
             "position resolution of a second search around each of the best solutions (Thesis, "
             "7.3.1.2); 0: no second search, because least squares are finer");
  schema.add("match.finer_resolution_rad", &parameters.finer_resolution_rad, 0.0005, 0.5, "rad",
             "heading resolution of the second search");
  schema.fix({"match.crossover_rate", "match.elite", "match.resolution_rad"});
}

void describe(GateConfig& config, support::ConfigSchema& schema) {
  schema.add("gate.smallest_overlap", &config.smallest_overlap, 0.0, 1.0, "",
             "smallest share of points in the view of the other map; below it a match is rejected");
  schema.add("gate.smallest_inliers", &config.smallest_inliers, 0.0, 1.0, "",
             "smallest share of those points that lie on a surface; below it a match is rejected");
  schema.add("gate.largest_doubt", &config.largest_doubt, 0.1, 10.0, "",
             "limit on the evidence against a match; smaller: fewer wrong matches, fewer loops");
  schema.add("gate.doubt_per_search_m", &config.doubt_per_search_m, 0.0, 10.0, "1/m",
             "reduction of that limit per metre of the search's half-width, because a wider search "
             "meets more look-alikes");
  schema.add(
      "gate.largest_mahalanobis2", &config.largest_mahalanobis2, 1.0, 1000.0, "",
      "largest squared Mahalanobis distance from the prediction; above it a match is rejected");
  schema.add("gate.largest_ambiguity", &config.largest_ambiguity, 0.1, 1.0, "",
             "largest ratio of the second best distinct solution's fitness to the best one's; "
             "above it a match is rejected");
}

}  // namespace topogeo::localization
