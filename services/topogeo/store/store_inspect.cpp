// topogeo store info, check, repair and list.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/exchange/inspect.hpp"
#include "topogeo/exchange/read_text.hpp"
#include "topogeo/exchange/repair.hpp"
#include "topogeo/exchange/sessions.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/format.hpp"

#include "common/configuration.hpp"
#include "store/store_commands.hpp"
#include "store/store_files.hpp"

namespace topogeo::cli {
namespace {

namespace fs = std::filesystem;

struct InspectOptions {
  fs::path file;
  bool json = false;
};

int store_info(const InspectOptions& options) {
  const storage::MapDocument map = read_any_map(options.file);
  const exchange::MapSummary summary = exchange::summarize(map);
  const std::uint64_t bytes = fs::file_size(options.file);
  std::cout << (options.json ? exchange::summary_json(summary, bytes)
                             : exchange::summary_text(summary, bytes));
  if (options.json) return service::kOk;
  for (const exchange::SessionSummary& s : exchange::sessions_of(map)) {
    std::cout << fmt::format("session    {}: {} stops, {:.1f} s\n",
                             exchange::session_text(s.session), s.stops,
                             static_cast<double>(s.last_stamp_ns - s.first_stamp_ns) * 1e-9);
  }
  return service::kOk;
}

void print_json(const nlohmann::ordered_json& json) {
  std::cout << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
}

int print_check_json(const fs::path& file, const std::vector<std::string>& contradictions,
                     const std::string& damage, int code) {
  print_json({{"file", file.string()},
              {"good", damage.empty() && contradictions.empty()},
              {"damage", damage},
              {"contradictions", contradictions}});
  return code;
}

int store_check(const InspectOptions& options) {
  // Reading checks blobs, hashes and references.
  std::vector<std::string> found;
  try {
    found = exchange::contradictions(read_any_map(options.file));
  } catch (const service::BadInputError& error) {
    if (!options.json) throw;
    return print_check_json(options.file, {}, error.what(), service::kBadInput);
  }
  const int code = found.empty() ? service::kOk : service::kFailure;
  if (options.json) return print_check_json(options.file, found, "", code);
  for (const std::string& line : found) {
    std::cout << options.file.string() << ": " << line << '\n';
  }
  if (found.empty()) std::cout << options.file.string() << ": no fault found\n";
  return code;
}

/// A readable map as `store info --json` describes it, after its file; else the damage.
nlohmann::ordered_json listed_map(const fs::path& file, const std::string& name) {
  nlohmann::ordered_json map = {{"file", name}, {"damage", ""}};
  try {
    const exchange::MapSummary summary = exchange::summarize(read_any_map(file));
    map.update(nlohmann::ordered_json::parse(exchange::summary_json(summary, fs::file_size(file))));
  } catch (const std::exception& error) {
    map["damage"] = error.what();
  }
  return map;
}

std::string list_line(const fs::path& file) {
  try {
    const exchange::MapSummary s = exchange::summarize(read_any_map(file));
    return fmt::format(
        "{:16} {:3} sessions {:5} stops {:8.1f} m {:5} nodes {:5} branches {:4} "
        "loops {:10} bytes",
        s.robot_id, s.sessions, s.stops, s.driven_m, s.node_count(), s.branches, s.loops,
        fs::file_size(file));
  } catch (const std::exception& error) {
    return error.what();
  }
}

int store_list(const fs::path& directory, bool as_json) {
  std::vector<fs::path> files;
  try {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(directory)) {
      if (entry.is_regular_file() && looks_like_map(entry.path())) files.push_back(entry.path());
    }
  } catch (const fs::filesystem_error& error) {
    throw service::BadInputError(error.what());
  }
  std::ranges::sort(files);
  if (as_json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const fs::path& file : files) {
      list.push_back(listed_map(file, fs::relative(file, directory).string()));
    }
    print_json(list);
    return service::kOk;
  }
  for (const fs::path& file : files) {
    std::cout << fmt::format("{:32} {}\n", fs::relative(file, directory).string(), list_line(file));
  }
  if (files.empty()) std::cerr << "topogeo: no map in " << directory.string() << '\n';
  return service::kOk;
}

struct RepairOptions {
  fs::path file;
  fs::path out;
  std::optional<fs::path> config;
};

int store_repair(const RepairOptions& options) {
  const pipeline::Config config = read_config(options.config);
  exchange::RepairedMap repaired;
  try {
    const std::string name = options.file.string();
    const exchange::StoredPieces pieces =
        looks_like_database(options.file)
            ? exchange::pieces_of_database(options.file)
            : exchange::pieces_of_map_file(exchange::read_map_bytes(options.file), name);
    repaired = exchange::assemble(pieces, config.global_map, name);
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
  storage::write_map_file(options.out, repaired.document);
  for (const std::string& line : repaired.lost) std::cout << line << '\n';
  for (const std::string& line : exchange::contradictions(repaired.document)) {
    std::cout << "still: " << line << '\n';
  }
  std::cout << fmt::format(
      "{}: {} stops, {} nodes, {} branches, {} places, {} zones{}\n", options.out.string(),
      repaired.document.local_maps.size(), repaired.document.global_map.nodes.size(),
      repaired.document.global_map.branches.size(), repaired.document.drawing.places.size(),
      repaired.document.drawing.zones.size(), repaired.lost.empty() ? ", nothing was lost" : "");
  return service::kOk;
}

}  // namespace

void add_store_inspect_commands(command_line::Command& store, int& exit_code) {
  command_line::Command* info = store.add_subcommand("info", "Show the content of a map");
  auto shown = std::make_shared<InspectOptions>();
  info->add_option("file", shown->file, "map file or database")->required()->type_name("FILE");
  info->add_flag("--json", shown->json, "print all numbers as JSON");
  info->callback([shown, &exit_code] { exit_code = store_info(*shown); });

  command_line::Command* check =
      store.add_subcommand("check", "Find damage and contradictions in a map");
  auto checked = std::make_shared<InspectOptions>();
  check->add_option("file", checked->file, "map file or database")->required()->type_name("FILE");
  check->add_flag("--json", checked->json,
                  "for programs: file, good, damage (empty: it can be read), contradictions");
  check->footer(
      "Reads all of it: checksums and hashes, every element, every reference; then stamps, poses,\n"
      "covariances and the ends of branches.\n"
      "Exit codes: 0 no fault, 1 contradictions, 3 damaged or no map.");
  check->callback([checked, &exit_code] { exit_code = store_check(*checked); });

  command_line::Command* repair =
      store.add_subcommand("repair", "Save the readable parts of a damaged map");
  auto damaged = std::make_shared<RepairOptions>();
  repair->add_option("file", damaged->file, "damaged map file or database")
      ->required()
      ->type_name("FILE");
  repair->add_option("--out", damaged->out, "map file to write (map.pb)")
      ->required()
      ->type_name("MAP");
  repair
      ->add_option("--config", damaged->config, "configuration (YAML), for its global_map section")
      ->type_name("FILE");
  repair->footer(
      "Prints what was lost. FILE stays as it is. A local map, pose or loop that cannot be read\n"
      "costs itself alone; poses that are missing follow from scan tracking, nodes and branches\n"
      "are made anew from the stops.");
  repair->callback([damaged, &exit_code] { exit_code = store_repair(*damaged); });

  command_line::Command* list =
      store.add_subcommand("list", "List the maps in a folder and its subfolders");
  auto directory = std::make_shared<fs::path>(".");
  list->add_option("directory", *directory, "folder")->capture_default_str()->type_name("DIR");
  auto as_json = std::make_shared<bool>(false);
  list->add_flag("--json", *as_json,
                 "for programs: each map with its file, damage (empty: it can be read) and the\n"
                 "numbers of info --json");
  list->callback(
      [directory, as_json, &exit_code] { exit_code = store_list(*directory, *as_json); });
}

}  // namespace topogeo::cli
