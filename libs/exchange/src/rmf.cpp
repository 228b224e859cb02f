#include "topogeo/exchange/rmf.hpp"

#include <nlohmann/json.hpp>

#include "topogeo/support/format.hpp"

#include "text.hpp"

namespace topogeo::exchange {
namespace {

/// In double quotes, with the escapes of JSON, which YAML shares.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump();
}

std::string lane(std::uint32_t from, std::uint32_t to, const DrivingRule& rule) {
  const std::string params =
      rule.speed_mps ? "speed_limit: " + number_text(*rule.speed_mps) : std::string();
  return fmt::format("      - [{}, {}, {{{}}}]\n", from, to, params);
}

}  // namespace

std::string rmf_text(const RouteNetwork& network, std::span<const planning::Place> places,
                     const std::string& building, const std::string& level) {
  std::string text =
      fmt::format("building_name: {}\ndoors: {{}}\nlifts: {{}}\nlevels:\n  {}:\n    vertices:\n",
                  quoted(building), quoted(level));
  if (network.nodes.empty()) text += "      []\n";
  for (const NetworkNode& node : network.nodes) {
    const std::string name = node.place ? places[*node.place].name : std::string();
    const char* parking = node.place ? ", is_parking_spot: true" : "";
    text += fmt::format("      - [{}, {}, {{name: {}{}}}]\n", number_text(node.position_m.x()),
                        number_text(node.position_m.y()), quoted(name), parking);
  }
  text += "    lanes:\n";
  if (network.pieces.empty()) text += "      []\n";
  for (const NetworkPiece& piece : network.pieces) {
    if (piece.rule.forward) text += lane(piece.from, piece.to, piece.rule);
    if (piece.rule.backward) text += lane(piece.to, piece.from, piece.rule);
  }
  return text;
}

}  // namespace topogeo::exchange
