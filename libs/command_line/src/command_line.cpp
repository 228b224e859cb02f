#include "topogeo/command_line/command_line.hpp"

#include <iostream>
#include <string_view>

#include <CLI/CLI.hpp>

#include "generated_help.hpp"

namespace topogeo::command_line {

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
    : program_(std::make_unique<CLI::App>(description, name)), app_(program_.get()) {}

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

void Command::set_version_flag(const std::string& names, const std::string& version) {
  app_->set_version_flag(names, version);
}

std::optional<int> Command::parse(int argc, const char* const* argv) {
  if (argc == 2 && argv[1] == std::string_view("--print-manual")) {
    std::cout << manual_page(*app_);
    return 0;
  }
  if (argc == 2 && argv[1] == std::string_view("--print-completion")) {
    std::cout << bash_completion(*app_);
    return 0;
  }
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& success) {  // --help, --version
    return app_->exit(success);
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
