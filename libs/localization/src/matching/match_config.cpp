#include "topogeo/localization/matching/match_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::localization {

void describe(GeneticParameters& parameters, support::ConfigSchema& schema) {
  schema.add("match.individuals", &parameters.individuals, 4U, 10000U, "",
             "population of the genetic search");
  schema.add("match.generations", &parameters.generations, 1U, 10000U, "",
             "50 x 30 with refinement is as good as the 100 x 50 of the thesis");
  schema.add("match.crossover_rate", &parameters.crossover_rate, 0.0, 1.0, "",
             "probability that two parents exchange genes");
  schema.add("match.mutation_rate", &parameters.mutation_rate, 0.0, 0.5, "",
             "probability for each bit");
  schema.add("match.elite", &parameters.elite, 1U, 100U, "",
             "best individuals that live on unchanged");
  schema.add("match.branch_hypotheses", &parameters.branch_hypotheses, 0U, 1000U, "",
             "initial individuals, at most, that lay a branch or node on an equivalent one");
  schema.add("match.resolution_m", &parameters.resolution_m, 0.005, 2.0, "m",
             "of the position genes");
  schema.add("match.resolution_rad", &parameters.resolution_rad, 0.001, 0.5, "rad",
             "of the heading gene");
  schema.add("match.finer_resolution_m", &parameters.finer_resolution_m, 0.0, 2.0, "m",
             "of a second search around each of the best solutions (Thesis, 7.3.1.2); 0: none, as "
             "least squares are finer");
  schema.add("match.finer_resolution_rad", &parameters.finer_resolution_rad, 0.0005, 0.5, "rad",
             "of its heading gene");
}

void describe(GateConfig& config, support::ConfigSchema& schema) {
  schema.add("gate.smallest_overlap", &config.smallest_overlap, 0.0, 1.0, "",
             "share of points in the other map's view below which a match is rejected");
  schema.add("gate.smallest_inliers", &config.smallest_inliers, 0.0, 1.0, "",
             "share of those that lie on a surface below which a match is rejected");
  schema.add("gate.largest_doubt", &config.largest_doubt, 0.1, 10.0, "",
             "limit on the evidence against a match; smaller: fewer wrong ones, fewer loops");
  schema.add("gate.doubt_per_search_m", &config.doubt_per_search_m, 0.0, 10.0, "1/m",
             "how much the limit falls with the half-width of the search: in a wider one "
             "look-alikes are likelier");
  schema.add("gate.largest_mahalanobis2", &config.largest_mahalanobis2, 1.0, 1000.0, "",
             "squared distance from the prediction in standard deviations above which a match is "
             "rejected");
  schema.add(
      "gate.largest_ambiguity", &config.largest_ambiguity, 0.1, 1.0, "",
      "fitness of the second best distinct solution over the best above which a match is rejected");
}

}  // namespace topogeo::localization
