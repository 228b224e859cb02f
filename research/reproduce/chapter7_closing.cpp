#include "reproduce/chapter7_closing.hpp"

#include <stdexcept>

#include "reproduce/drawing.hpp"

namespace topogeo::reproduce {

using render::FigurePanel;

const Correction::Backward& first_closing(const Correction& correction) {
  if (correction.backward.empty()) throw std::runtime_error("no cycle was closed");
  return correction.backward.front();
}

bool closes(Report& report, const Correction& correction) {
  report.made_by(means_of(report.runs().drive(kTurn), correction));
  report.states("the view after the turn closes a cycle", !correction.backward.empty());
  return !correction.backward.empty();
}

FigurePanel corridor_panel(const Drive& drive, const std::string& title) {
  FigurePanel panel;
  panel.title = title;
  add_walls(panel, drive.world, drive.T_world_first);
  panel.extent = {{-4.0, -4.0}, {4.0, 32.0}};
  return panel;
}

}  // namespace topogeo::reproduce
