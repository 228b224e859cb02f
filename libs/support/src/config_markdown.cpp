// The tables of parameters for the documentation.
#include <algorithm>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/support/config_schema.hpp"

namespace topogeo::support {
namespace {

/// Text for a table cell: on one line, without characters that Markdown reads as layout.
std::string cell_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '<' || c == '*') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

std::string section_of(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string::npos ? "" : key.substr(0, dot);
}

void write_row(const ConfigParameter& p, std::ostream& out) {
  out << "| `" << p.key.substr(p.key.rfind('.') + 1) << "` | ";
  if (!p.default_text.empty()) out << '`' << p.default_text << '`';
  out << " | " << cell_text(p.expected) << " | " << cell_text(p.why) << " |\n";
}

}  // namespace

void write_markdown(const ConfigSchema& schema, std::ostream& out) {
  std::vector<std::string> done;
  for (const ConfigParameter& first : schema.parameters()) {
    if (first.fixed) continue;
    const std::string section = section_of(first.key);
    if (std::ranges::find(done, section) != done.end()) continue;
    if (!done.empty()) out << '\n';
    done.push_back(section);
    if (!section.empty()) out << "### `" << section << "`\n\n";
    out << "| key | default | expected | meaning |\n|---|---|---|---|\n";
    for (const ConfigParameter& p : schema.parameters()) {
      if (!p.fixed && section_of(p.key) == section) write_row(p, out);
    }
  }
}

}  // namespace topogeo::support
