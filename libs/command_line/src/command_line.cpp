#include "topogeo/command_line/command_line.hpp"

#include <algorithm>
#include <iostream>
#include <numeric>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>

#include "generated_help.hpp"
#include "help_format.hpp"

namespace topogeo::command_line {
namespace {

/// "help a b" as "a b --help".
std::vector<std::string> without_help_word(std::vector<std::string> words) {
  if (words.empty() || words.front() != "help") return words;
  words.erase(words.begin());
  words.emplace_back("--help");
  return words;
}

/// Number of letters to insert, delete or replace (Levenshtein 1966).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

/// The name of the subcommand that is nearest to a word; empty if none is near.
std::string nearest_command(const CLI::App& app, const std::string& word) {
  std::string nearest;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    const std::size_t distance = edit_distance(word, command->get_name());
    if (command->get_name().empty() || distance >= least) continue;
    least = distance;
    nearest = command->get_name();
  }
  return nearest;
}

/// Throws for a word in the place of a subcommand that is none: CLI11 would say that one is
/// required.
void check_commands(const CLI::App& root, const std::vector<std::string>& words) {
  const CLI::App* app = &root;
  std::string path = root.get_name();
  for (const std::string& word : words) {
    if (word.starts_with('-') || app->get_require_subcommand_min() == 0) return;
    const std::vector<const CLI::App*> commands =
        app->get_subcommands([&](const CLI::App* command) { return command->get_name() == word; });
    if (commands.empty()) {
      const std::string nearest = nearest_command(*app, word);
      throw UsageError("there is no command '" + word + "'" +
                       (nearest.empty() ? "" : ", did you mean '" + nearest + "'?") + " (see " +
                       (path.empty() ? "" : path + ' ') + "--help)");
    }
    app = commands.front();
    path += ' ' + word;
  }
}

/// Names the arguments that no option takes, in the order in which they were typed.
std::string unexpected(const std::vector<std::string>& words, std::vector<std::string> extras) {
  std::string text = extras.size() == 1 ? "The following argument was not expected:"
                                        : "The following arguments were not expected:";
  for (const std::string& word : words) {
    const auto extra = std::ranges::find(extras, word);
    if (extra == extras.end()) continue;
    extras.erase(extra);
    text += ' ' + word;
  }
  return text;
}

}  // namespace

Check::Check(const CLI::Validator& validator)
    : validator_(std::make_shared<const CLI::Validator>(validator)) {}

Check range(int smallest, int largest) {
  return Check(CLI::Range(smallest, largest));
}

Check range(std::uint32_t smallest, std::uint32_t largest) {
  return Check(CLI::Range(smallest, largest));
}

Check range(std::uint64_t smallest, std::uint64_t largest) {
  return Check(CLI::Range(smallest, largest));
}

Check range(double smallest, double largest) {
  return Check(CLI::Range(smallest, largest));
}

Check positive_number() {
  return Check(CLI::PositiveNumber);
}

Check one_of(const std::vector<std::string>& values) {
  return Check(CLI::IsMember(values));
}

Check one_of(std::initializer_list<int> values) {
  return Check(CLI::IsMember(std::vector<int>(values)));
}

Check existing_file() {
  return Check(CLI::ExistingFile);
}

Check existing_directory() {
  return Check(CLI::ExistingDirectory);
}

Option* Option::required(bool value) {
  option_->required(value);
  return this;
}

Option* Option::check(const Check& check) {
  option_->check(*check.validator_);
  return this;
}

Option* Option::check(const std::function<std::string(const std::string&)>& test) {
  option_->check(test);
  return this;
}

Option* Option::named_values(const std::vector<std::pair<std::string, std::uint32_t>>& values) {
  option_->transform(CLI::CheckedTransformer(values).description(""));
  words_.clear();
  for (const auto& [name, number] : values) words_.push_back(name);
  return this;
}

Option* Option::completed_by(std::vector<std::string> words) {
  words_ = std::move(words);
  return this;
}

Option* Option::needs(const Option* other) {
  option_->needs(other->option_);
  return this;
}

Option* Option::excludes(const Option* other) {
  option_->excludes(other->option_);
  return this;
}

Option* Option::type_name(const std::string& name) {
  option_->type_name(name);
  return this;
}

Option* Option::capture_default_str() {
  option_->capture_default_str();
  return this;
}

Option* Option::environment(const std::string& variable) {
  option_->envname(variable);
  return this;
}

Option* Option::default_str(const std::string& text) {
  option_->default_str(text);
  return this;
}

Option* Option::delimiter(char separator) {
  option_->delimiter(separator);
  return this;
}

Option* Option::allow_extra_args(bool value) {
  option_->allow_extra_args(value);
  return this;
}

std::size_t Option::count() const {
  return option_->count();
}

Command::Command(const std::string& description, const std::string& name)
    : program_(std::make_unique<CLI::App>(description, name)), app_(program_.get()) {
  app_->formatter(help_format());  // subcommands inherit it
}

Command::Command(CLI::App& app) : app_(&app) {}

Command::~Command() = default;

Option* Command::keep(CLI::Option* option) {
  return options_.emplace_back(std::make_unique<Option>(*option)).get();
}

Command* Command::keep(CLI::App* app) {
  return parts_.emplace_back(std::unique_ptr<Command>(new Command(*app))).get();
}

template <OptionValue T>
Option* Command::add_option(const std::string& names, T& value, const std::string& description) {
  return keep(app_->add_option(names, value, description));
}

Option* Command::add_option_function(const std::string& names,
                                     std::function<void(const std::string&)> take,
                                     const std::string& description) {
  const auto checked = [names, take = std::move(take)](const std::string& text) {
    try {
      take(text);
    } catch (const std::invalid_argument& error) {
      throw CLI::ValidationError(names, error.what());
    }
  };
  return keep(app_->add_option_function<std::string>(names, checked, description));
}

Option* Command::add_flag(const std::string& names, bool& value, const std::string& description) {
  return keep(app_->add_flag(names, value, description));
}

Option* Command::find(const CLI::Option* option) const {
  for (const auto& kept : options_) {
    if (kept->option_ == option) return kept.get();
  }
  for (const auto& part : parts_) {
    if (Option* found = part->find(option)) return found;
  }
  return nullptr;
}

Option* Command::get_option(const std::string& name) const {
  Option* const option = find(app_->get_option_no_throw(name));
  if (option == nullptr) throw std::invalid_argument(name + ": no option of this command");
  return option;
}

Command* Command::add_subcommand(const std::string& name, const std::string& description) {
  return keep(app_->add_subcommand(name, description));
}

Command* Command::add_option_group(const std::string& name, const std::string& description) {
  return keep(app_->add_option_group(name, description));
}

void Command::require_subcommand(int count) {
  app_->require_subcommand(count);
}

void Command::require_option(int count) {
  app_->require_option(count);
}

void Command::callback(std::function<void()> call) {
  app_->callback(std::move(call));
}

void Command::footer(const std::string& text) {
  app_->footer(text);
}

void Command::group_subcommands(const std::string& heading,
                                std::initializer_list<const char*> names) {
  for (const char* name : names) app_->get_subcommand(name)->group(heading);
}

void Command::set_version_flag(const std::string& names, const std::string& version) {
  app_->set_version_flag(names, version);
}

std::optional<int> Command::parse(int argc, const char* const* argv) {
  if (argc == 2 && argv[1] == std::string_view("--print-manual")) {
    std::cout << manual_page(*app_);
    return 0;
  }
  if (argc == 3 && argv[1] == std::string_view("--print-manual")) {
    std::cout << manual_page(*app_, argv[2]);
    return 0;
  }
  if (argc == 2 && argv[1] == std::string_view("--print-commands")) {
    for (const std::string& name : command_names(*app_)) std::cout << name << '\n';
    return 0;
  }
  if (argc == 2 && argv[1] == std::string_view("--print-completion")) {
    const auto words_of = [this](const CLI::Option& option) {
      const Option* const found = find(&option);
      return found == nullptr ? std::vector<std::string>{} : found->words_;
    };
    std::cout << bash_completion(*app_, words_of);
    return 0;
  }
  const std::vector<std::string> words = without_help_word({argv + 1, argv + argc});
  check_commands(*app_, words);
  std::vector<const char*> arguments = {argv[0]};
  for (const std::string& word : words) arguments.push_back(word.c_str());
  try {
    app_->parse(static_cast<int>(arguments.size()), arguments.data());
  } catch (const CLI::Success& success) {  // --help, --version
    return app_->exit(success);
  } catch (const CLI::ExtrasError&) {
    throw UsageError(unexpected(words, app_->remaining(true)) + " (see --help)");
  } catch (const CLI::ParseError& error) {
    throw UsageError(std::string(error.what()) + " (see --help)");
  }
  return std::nullopt;
}

std::optional<int> Command::parse_or_report(int argc, const char* const* argv) {
  constexpr int kWrongUsage = 2;
  try {
    return parse(argc, argv);
  } catch (const UsageError& error) {
    std::cerr << error.what() << '\n';
  }
  return kWrongUsage;
}

// Instantiates the types of OptionValue that programs use.
template Option* Command::add_option(const std::string&, std::string&, const std::string&);
template Option* Command::add_option(const std::string&, std::filesystem::path&,
                                     const std::string&);
template Option* Command::add_option(const std::string&, int&, const std::string&);
template Option* Command::add_option(const std::string&, std::uint32_t&, const std::string&);
template Option* Command::add_option(const std::string&, std::uint64_t&, const std::string&);
template Option* Command::add_option(const std::string&, double&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<std::string>&,
                                     const std::string&);
template Option* Command::add_option(const std::string&, std::optional<std::filesystem::path>&,
                                     const std::string&);
template Option* Command::add_option(const std::string&, std::optional<int>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<std::uint32_t>&,
                                     const std::string&);
template Option* Command::add_option(const std::string&, std::optional<std::uint64_t>&,
                                     const std::string&);
template Option* Command::add_option(const std::string&, std::optional<double>&,
                                     const std::string&);
template Option* Command::add_option(const std::string&, std::vector<std::string>&,
                                     const std::string&);
template Option* Command::add_option(const std::string&, std::vector<std::filesystem::path>&,
                                     const std::string&);

}  // namespace topogeo::command_line
