#include "topogeo/exchange/rmf.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/results/outputs.hpp"

#include "readers.hpp"
#include "sample_floor.hpp"
#include "sample_stops.hpp"

namespace topogeo::exchange {
namespace {

class Rmf : public ScratchTest {};

TEST_F(Rmf, KeepsTheRulesOfTheFleetAdapter) {
  const RouteNetwork network = route_network(sample_graph(), sample_drawing(), nullptr, {});
  const std::string text = rmf_text(network, sample_drawing().places, "floor: \"1\"", "L1");
  std::size_t lanes = 0;
  for (const NetworkPiece& piece : network.pieces) {
    lanes += piece.rule.forward;
    lanes += piece.rule.backward;
  }
  // The names of the two places are the last lines.
  EXPECT_EQ(run_reader({"rmf", write("0.yaml", text)}),
            "L1 " + std::to_string(network.nodes.size()) + " " + std::to_string(lanes) +
                " 4\nKüche\nroom <A> & \"B\"\n");
}

TEST_F(Rmf, AnEmptyMapIsAnEmptyGraph) {
  EXPECT_EQ(run_reader({"rmf", write("0.yaml", rmf_text({}, {}, "b", "L1"))}), "L1 0 0 0\n");
}

TEST_F(Rmf, PicturesAreOpenedByOtherPrograms) {
  storage::MapDocument document = sample_stops();
  document.global_map = sample_graph();
  const std::filesystem::path svg = write("map.svg", results::map_svg(document, "sample"));
  run_program({"rsvg-convert", "-o", directory_ / "svg.png", svg});
  const std::filesystem::path png = write("map.png", results::map_png(document, "sample"));
  const std::string size = run_reader({"picture", png});
  EXPECT_EQ(run_reader({"picture", directory_ / "svg.png"}), size);
}

}  // namespace
}  // namespace topogeo::exchange
