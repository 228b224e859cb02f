// Command lines of programs: options, flags, subcommands, their checks and help. CLI11 does the
// work; only this library includes it, because each file that does takes seconds to compile.
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
class Option;
class Validator;
}  // namespace CLI

namespace topogeo::command_line {

/// The command line is wrong; what() names the option, the value and the expected input.
class UsageError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

template <class T, class... Types>
concept OneOf = (std::same_as<T, Types> || ...);

template <class T>
concept SingleValue =
    OneOf<T, std::string, std::filesystem::path, int, std::uint32_t, std::uint64_t, double>;

/// Types that an option can be stored in. An optional stays empty if the option is not given; a
/// vector takes all values that follow the option.
template <class T>
concept OptionValue = SingleValue<T> ||
    OneOf<T, std::vector<std::string>, std::vector<std::filesystem::path>> ||
    (SingleValue<typename T::value_type>&& OneOf<T, std::optional<typename T::value_type>>);

/// A condition on the values of an option.
class Check {
 public:
  explicit Check(const CLI::Validator& validator);

 private:
  friend class Option;
  std::shared_ptr<const CLI::Validator> validator_;
};

/// A number from `smallest` to `largest`, both allowed.
Check range(int smallest, int largest);
Check range(std::uint32_t smallest, std::uint32_t largest);
Check range(std::uint64_t smallest, std::uint64_t largest);
Check range(double smallest, double largest);
Check positive_number();
Check one_of(const std::vector<std::string>& values);
Check one_of(std::initializer_list<int> values);
Check existing_file();
Check existing_directory();

/// An option, a positional argument or a flag of a Command. Each function returns the option
/// itself.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}

  Option* required(bool value = true);
  Option* check(const Check& check);
  /// `test` returns the fault of a value, or an empty text for a good one.
  Option* check(const std::function<std::string(const std::string&)>& test);
  /// The value is a number that is given by its name. Completion offers the names; help does not
  /// list them.
  Option* named_values(const std::vector<std::pair<std::string, std::uint32_t>>& values);
  /// Adds words that completion offers beside those of one_of(). Other values stay allowed.
  Option* completed_by(std::vector<std::string> words);
  Option* needs(const Option* other);
  Option* excludes(const Option* other);
  /// Sets the name of the value in help: FILE, X,Y.
  Option* type_name(const std::string& name);
  /// Help shows the current value of the variable as the default.
  Option* capture_default_str();
  Option* default_str(const std::string& text);
  /// If the option is not given, this environment variable supplies the value.
  Option* environment(const std::string& variable);
  /// One value contains several parts, separated by this character.
  Option* delimiter(char separator);
  /// For an option stored in a vector: whether it takes all values up to the next option, or one
  /// value each time it is given.
  Option* allow_extra_args(bool value);

  /// Number of values on the command line.
  [[nodiscard]] std::size_t count() const;

 private:
  friend class Command;
  CLI::Option* option_;
  std::vector<std::string> words_{};  // of completed_by()
};

/// The command line of a program, one of its subcommands or a group of options. Variables that
/// options are stored in must outlive it.
class Command {
 public:
  explicit Command(const std::string& description, const std::string& name = "");
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  /// `names` are "--name", "-n,--name", or "name" for an argument in that position.
  template <OptionValue T>
  Option* add_option(const std::string& names, T& value, const std::string& description = "");
  /// Calls `take` with the value; a std::invalid_argument that it throws is reported as the fault
  /// of the value.
  Option* add_option_function(const std::string& names,
                              std::function<void(const std::string&)> take,
                              const std::string& description = "");
  /// `names` may end in ",!--no-name", which sets the flag to false.
  Option* add_flag(const std::string& names, bool& value, const std::string& description = "");
  /// Throws std::invalid_argument when the command has no such option.
  [[nodiscard]] Option* get_option(const std::string& name) const;

  Command* add_subcommand(const std::string& name, const std::string& description);
  /// Groups options that help shows together; require_option counts them.
  Command* add_option_group(const std::string& name, const std::string& description);
  void require_subcommand(int count);
  void require_option(int count);
  /// Calls `call` after parsing, if the command line contains this command.
  void callback(std::function<void()> call);
  /// Text that help prints below the options.
  void footer(const std::string& text);
  /// Lists these subcommands under a heading of their own in help. Throws for an unknown name.
  void group_subcommands(const std::string& heading, std::initializer_list<const char*> names);
  void set_version_flag(const std::string& names, const std::string& version);

  /// Fills the variables and runs the callbacks. Returns an exit code if the program has nothing
  /// left to do, because help or the version was printed. "help COMMAND" is "COMMAND --help".
  /// Throws UsageError, which names the nearest command to an unknown one. The hidden options
  /// --print-manual and --print-completion, each as the only argument, print the manual page and
  /// the completion for bash.
  [[nodiscard]] std::optional<int> parse(int argc, const char* const* argv);
  /// Like parse(), for programs that have no exit codes of their own: prints the fault to stderr
  /// and returns 2.
  [[nodiscard]] std::optional<int> parse_or_report(int argc, const char* const* argv);

 private:
  explicit Command(CLI::App& app);
  Option* keep(CLI::Option* option);
  Command* keep(CLI::App* app);
  [[nodiscard]] Option* find(const CLI::Option* option) const;

  std::unique_ptr<CLI::App> program_;  // root command only
  CLI::App* app_;
  std::vector<std::unique_ptr<Option>> options_;
  std::vector<std::unique_ptr<Command>> parts_;  // subcommands and groups
};

}  // namespace topogeo::command_line
