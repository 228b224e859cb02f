#include "topogeo/command_line/command_line.hpp"

#include <cstdio>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::command_line {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::optional<int> parse(Command& command, std::vector<const char*> words) {
  words.insert(words.begin(), "program");
  return command.parse(static_cast<int>(words.size()), words.data());
}

/// The error for a command line; empty when it is valid.
std::string complaint(Command& command, const std::vector<const char*>& words) {
  try {
    EXPECT_FALSE(parse(command, words));
    return {};
  } catch (const UsageError& error) {
    return error.what();
  }
}

TEST(CommandLine, StoresEachTypeOfValue) {
  Command command("a test");
  std::string text;
  std::filesystem::path path;
  int number = 0;
  std::uint32_t small = 0;
  std::uint64_t large = 0;
  double real = 0.0;
  bool flag = false;
  command.add_option("text", text);
  command.add_option("--path", path);
  command.add_option("-n,--number", number);
  command.add_option("--small", small);
  command.add_option("--large", large);
  command.add_option("--real", real);
  command.add_flag("--flag", flag);

  EXPECT_FALSE(parse(command, {"a text", "--path", "a/file", "-n", "-3", "--small", "4",
                               "--large=18446744073709551615", "--real", "0.25", "--flag"}));

  EXPECT_EQ(text, "a text");
  EXPECT_EQ(path, "a/file");
  EXPECT_EQ(number, -3);
  EXPECT_EQ(small, 4U);
  EXPECT_EQ(large, 18446744073709551615ULL);
  EXPECT_EQ(real, 0.25);
  EXPECT_TRUE(flag);
}

TEST(CommandLine, LeavesWhatIsNotGivenAsItIs) {
  Command command("a test");
  int number = 7;
  std::optional<double> given;
  std::optional<std::string> missing;
  command.add_option("--number", number);
  const Option* given_option = command.add_option("--given", given);
  const Option* missing_option = command.add_option("--missing", missing);

  EXPECT_FALSE(parse(command, {"--given", "1.5"}));

  EXPECT_EQ(number, 7);
  EXPECT_EQ(given, 1.5);
  EXPECT_EQ(missing, std::nullopt);
  EXPECT_EQ(given_option->count(), 1U);
  EXPECT_EQ(missing_option->count(), 0U);
}

TEST(CommandLine, CollectsListsFromWordsAndSeparators) {
  Command command("a test");
  std::vector<std::string> words;
  std::vector<std::string> parts;
  std::vector<std::string> single;
  std::string last;
  command.add_option("--words", words);
  command.add_option("--parts", parts)->delimiter(',');
  command.add_option("--single", single)->allow_extra_args(false);
  command.add_option("last", last);

  EXPECT_FALSE(parse(
      command, {"--words", "a", "b", "--parts", "c,d", "--single", "e", "--single", "f", "last"}));

  EXPECT_THAT(words, ElementsAre("a", "b"));
  EXPECT_THAT(parts, ElementsAre("c", "d"));
  EXPECT_THAT(single, ElementsAre("e", "f"));
  EXPECT_EQ(last, "last");
}

TEST(CommandLine, FlagsCanBeTurnedOff) {
  Command command("a test");
  bool tables = true;
  command.add_flag("--tables,!--no-tables", tables);
  EXPECT_FALSE(parse(command, {"--no-tables"}));
  EXPECT_FALSE(tables);
}

TEST(CommandLine, NamesWhatIsWrongWithAValue) {
  Command command("a test");
  std::uint32_t workers = 2;
  std::uint64_t scan = 0;
  double speed_mps = 1.0;
  std::string wheels = "mild";
  int baud = 9600;
  int count = 1;
  std::string name;
  command.add_option("--workers", workers)->check(range(0U, 256U));
  command.add_option("--scan", scan)->check(range(std::uint64_t{1}, std::uint64_t{5}));
  command.add_option("--speed", speed_mps)->check(range(0.5, 2.0));
  command.add_option("--wheels", wheels)->check(one_of({"mild", "b21"}));
  command.add_option("--baud", baud)->check(one_of({9600, 19200}));
  command.add_option("--count", count)->check(positive_number());
  command.add_option("--name", name)->check([](const std::string& text) {
    return text.size() > 3 ? "expected 3 bytes at most" : std::string();
  });

  EXPECT_EQ(complaint(command, {"--workers", "256", "--scan", "5", "--speed", "2", "--wheels",
                                "b21", "--baud", "19200", "--count", "1", "--name", "abc"}),
            "");
  EXPECT_EQ(complaint(command, {"--workers", "257"}),
            "--workers: Value 257 not in range 0 to 256 (see --help)");
  EXPECT_EQ(complaint(command, {"--scan", "0"}),
            "--scan: Value 0 not in range 1 to 5 (see --help)");
  EXPECT_EQ(complaint(command, {"--speed", "fast"}),
            "--speed: Value fast not in range 0.500000 to 2.000000 (see --help)");
  EXPECT_EQ(complaint(command, {"--wheels", "square"}),
            "--wheels: square not in {mild,b21} (see --help)");
  EXPECT_EQ(complaint(command, {"--baud", "5"}), "--baud: 5 not in {9600,19200} (see --help)");
  EXPECT_THAT(complaint(command, {"--count", "0"}), HasSubstr("--count: "));
  EXPECT_EQ(complaint(command, {"--name", "long"}),
            "--name: expected 3 bytes at most (see --help)");
}

TEST(CommandLine, ChecksThatFilesAndDirectoriesExist) {
  Command command("a test");
  std::string file;
  std::string directory;
  command.add_option("--file", file)->check(existing_file());
  command.add_option("--directory", directory)->check(existing_directory());
  EXPECT_THAT(complaint(command, {"--file", "/no/such/file"}), HasSubstr("/no/such/file"));
  EXPECT_THAT(complaint(command, {"--directory", "/no/such"}), HasSubstr("/no/such"));
  EXPECT_EQ(complaint(command, {"--file", "/proc/self/status", "--directory", "/"}), "");
}

TEST(CommandLine, TranslatesNamesIntoNumbers) {
  Command command("a test");
  std::uint32_t fault = 0;
  command.add_option("fault", fault)->required()->named_values({{"echo", 8}, {"silence", 2}});
  EXPECT_FALSE(parse(command, {"echo"}));
  EXPECT_EQ(fault, 8U);
  EXPECT_THAT(complaint(command, {"jump"}), HasSubstr("jump"));
}

TEST(CommandLine, KeepsOptionsTogetherAndApart) {
  Command command("a test");
  std::string log;
  std::string devices;
  bool quick = false;
  command.add_option("--log", log);
  command.add_option("--devices", devices)->excludes(command.get_option("--log"));
  command.add_flag("--quick", quick)->needs(command.get_option("--log"));
  EXPECT_EQ(complaint(command, {"--log", "a", "--quick"}), "");
  EXPECT_THAT(complaint(command, {"--log", "a", "--devices", "b"}), HasSubstr("excludes"));
  EXPECT_EQ(complaint(command, {"--quick"}), "--quick requires --log (see --help)");
}

TEST(CommandLine, GroupsCountTheirOptions) {
  Command command("a test");
  std::string log;
  std::string devices;
  Command* source = command.add_option_group("source", "where scans come from");
  Option* log_option = source->add_option("--log", log);
  source->add_option("--devices", devices);
  source->require_option(1);
  EXPECT_EQ(complaint(command, {"--log", "a"}), "");
  EXPECT_EQ(complaint(command, {}),
            "Exactly 1 option from [--log,--devices] is required (see --help)");
  EXPECT_EQ(command.get_option("--log"), log_option);
}

TEST(CommandLine, RefusesWhatIsMissingOrUnknown) {
  Command command("a test");
  std::string out;
  command.add_option("--out", out)->required();
  EXPECT_EQ(complaint(command, {}), "--out is required (see --help)");
  EXPECT_EQ(complaint(command, {"--out", "a", "--other"}),
            "The following argument was not expected: --other (see --help)");
  EXPECT_THROW(static_cast<void>(command.get_option("--other")), std::invalid_argument);
  command.get_option("--out")->required(false);
  EXPECT_EQ(complaint(command, {}), "");
}

TEST(CommandLine, ReportsWhatAFunctionDoesNotTake) {
  Command command("a test");
  std::string taken;
  command.add_option_function("--rate", [&](const std::string& text) {
    if (text == "fast") throw std::invalid_argument("rate 'fast': expected a number");
    taken = text;
  });
  EXPECT_EQ(complaint(command, {"--rate", "fast"}),
            "--rate: rate 'fast': expected a number (see --help)");
  EXPECT_EQ(complaint(command, {"--rate", "2"}), "");
  EXPECT_EQ(taken, "2");
}

TEST(CommandLine, CallsTheSubcommandThatIsGiven) {
  Command command("a test", "program");
  std::string called;
  int value = 0;
  for (const char* name : {"map", "plan"}) {
    Command* subcommand = command.add_subcommand(name, "a subcommand");
    subcommand->add_option("--value", value);
    subcommand->callback([&called, name] { called = name; });
  }
  command.require_subcommand(1);
  EXPECT_FALSE(parse(command, {"plan", "--value", "3"}));
  EXPECT_EQ(called, "plan");
  EXPECT_EQ(value, 3);
  EXPECT_EQ(complaint(command, {}), "A subcommand is required (see --help)");
}

TEST(CommandLine, NamesAnUnknownCommandAndTheNearestOne) {
  Command command("a test", "program");
  Command* store = command.add_subcommand("store", "a subcommand");
  store->add_subcommand("export", "a subcommand");
  store->add_subcommand("import", "a subcommand");
  store->require_subcommand(1);
  command.add_subcommand("map", "a subcommand");
  command.require_subcommand(1);
  EXPECT_EQ(complaint(command, {"mapp", "a.log"}),
            "there is no command 'mapp', did you mean 'map'? (see program --help)");
  EXPECT_EQ(complaint(command, {"store", "exprot", "--out", "a"}),
            "there is no command 'exprot', did you mean 'export'? (see program store --help)");
  EXPECT_EQ(complaint(command, {"telephone"}),
            "there is no command 'telephone' (see program --help)");
}

TEST(CommandLine, NamesArgumentsInTheOrderInWhichTheyWereTyped) {
  Command command("a test", "program");
  Command* map = command.add_subcommand("map", "a subcommand");
  std::string log;
  map->add_option("log,--log", log);
  command.require_subcommand(1);
  EXPECT_EQ(complaint(command, {"map", "a", "b", "--other", "c"}),
            "The following arguments were not expected: b --other c (see --help)");
  EXPECT_EQ(complaint(command, {"map", "a"}), "");
  EXPECT_EQ(log, "a");
  EXPECT_EQ(complaint(command, {"map", "--log", "b"}), "");
  EXPECT_EQ(log, "b");
}

TEST(CommandLine, HelpIsACommand) {
  Command command("What it does.", "program");
  command.add_subcommand("map", "Maps a log.");
  command.group_subcommands("Make maps", {"map"});
  command.require_subcommand(1);
  for (const auto& [words, text] : std::vector<std::pair<std::vector<const char*>, std::string>>{
           {{"help"}, "What it does."}, {{"help", "map"}, "Maps a log."}}) {
    testing::internal::CaptureStdout();
    EXPECT_EQ(parse(command, words), 0);
    const std::string help = testing::internal::GetCapturedStdout();
    EXPECT_THAT(help, HasSubstr(text));
    EXPECT_EQ(help.find("Make maps:") != std::string::npos, words.size() == 1);
  }
}

TEST(CommandLine, CallbacksMayThrow) {
  Command command("a test");
  command.callback([] { throw std::domain_error("failed"); });
  EXPECT_THROW(parse(command, {}), std::domain_error);
}

TEST(CommandLine, TakesValuesOfTheEnvironment) {
  const auto parsed = [](const std::vector<const char*>& words) {
    Command command("a test");
    std::uint32_t workers = 2;
    command.add_option("--workers", workers)->check(range(0U, 9U))->environment("TEST_WORKERS");
    EXPECT_FALSE(parse(command, words));
    return workers;
  };
  EXPECT_EQ(parsed({}), 2U);
  ::setenv("TEST_WORKERS", "5", 1);
  EXPECT_EQ(parsed({}), 5U);
  EXPECT_EQ(parsed({"--workers", "7"}), 7U);
  ::setenv("TEST_WORKERS", "many", 1);
  EXPECT_THROW(parsed({}), UsageError);
  ::unsetenv("TEST_WORKERS");
}

TEST(CommandLine, PrintsHelpAndVersion) {
  Command command("What it does.", "program");
  std::uint32_t workers = 2;
  std::string file;
  command.add_option("--workers", workers, "how many")->check(range(0U, 9U))->capture_default_str();
  command.add_option("--file", file, "the log")->type_name("FILE")->default_str("the last one");
  command.footer("More below.");
  command.set_version_flag("--version", "program 1.2");

  testing::internal::CaptureStdout();
  EXPECT_EQ(parse(command, {"--help"}), 0);
  const std::string help = testing::internal::GetCapturedStdout();
  EXPECT_THAT(help, HasSubstr("What it does.\nUsage: program [OPTIONS]"));
  EXPECT_THAT(help, HasSubstr("--workers N=2 (0 to 9)"));
  EXPECT_THAT(help, HasSubstr("--file FILE=the last one"));
  EXPECT_THAT(help, HasSubstr("More below."));

  testing::internal::CaptureStdout();
  EXPECT_EQ(parse(command, {"--version"}), 0);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "program 1.2\n");
}

TEST(CommandLine, ReportsWrongUsageForProgramsWithoutExitCodes) {
  Command command("a test");
  const std::vector<const char*> words = {"program", "--other"};
  testing::internal::CaptureStderr();
  EXPECT_EQ(command.parse_or_report(static_cast<int>(words.size()), words.data()), 2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "The following argument was not expected: --other (see --help)\n");
}

/// Output of a program with this argument.
std::string printed(Command& command, const char* word, const char* more = nullptr) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(more == nullptr ? parse(command, {word}) : parse(command, {word, more}), 0);
  return testing::internal::GetCapturedStdout();
}

struct ToolCommand {
  ToolCommand() {
    command.add_flag("--all", all, "everything - at once");
    Command* drive = command.add_subcommand("drive", "Drive somewhere");
    drive->add_option("--gear", gear, "how fast")
        ->check(one_of({"low", "high"}))
        ->default_str("low");
    drive->add_subcommand("home", "Drive home");
    command.add_subcommand("break", "Break a part")
        ->add_option("part", part, "which part")
        ->check(one_of({"wheel", "laser"}));
    Command* repair = command.add_subcommand("repair", "Repair a part");
    repair->add_option("how", how, "how")->named_values({{"glue", 1U}, {"weld", 2U}});
    repair->add_option("--by", by, "who")->completed_by({"anna", "ben"});
  }
  Command command{"Drives things. And more.", "tool"};
  std::string gear;
  std::string part;
  std::uint32_t how = 0;
  std::string by;
  bool all = false;
};

TEST(CommandLine, PrintsAManualPageOfItsOptions) {
  ToolCommand tool;
  const std::string page = printed(tool.command, "--print-manual");
  EXPECT_THAT(page, HasSubstr("tool \\- Drives things\n"));
  EXPECT_THAT(page, HasSubstr(".B \\-\\-all\neverything \\- at once\n"));
  EXPECT_THAT(page, HasSubstr(".BR tool\\-drive (1)\nDrive somewhere\n"));
  EXPECT_THAT(page, Not(HasSubstr("how fast"))) << "it has a page of its own";
}

TEST(CommandLine, PrintsAManualPageForEachCommand) {
  ToolCommand tool;
  EXPECT_EQ(printed(tool.command, "--print-commands"), "drive\nbreak\nrepair\n");
  const std::string page = printed(tool.command, "--print-manual", "drive");
  EXPECT_THAT(page, HasSubstr(".TH TOOL\\-DRIVE 1"));
  EXPECT_THAT(page, HasSubstr("tool\\-drive \\- Drive somewhere\n"));
  EXPECT_THAT(page, HasSubstr("how fast ({low,high}) (default: low)"));
  EXPECT_THAT(page, HasSubstr(".SS tool drive home\n"));
  EXPECT_THAT(page, HasSubstr(".BR tool (1)\n"));
  EXPECT_THAT(complaint(tool.command, {"--print-manual", "drvie"}), HasSubstr("got 'drvie'"));
}

/// Completions of bash for a line whose last word is unfinished.
std::string completed(const std::string& script, const std::string& line) {
  const std::string file = testing::TempDir() + "completion.bash";
  std::ofstream(file) << script << "COMP_WORDS=(" << line
                      << "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _tool; echo ${COMPREPLY[*]}";
  std::FILE* const output = ::popen(("bash " + file).c_str(), "r");
  std::string text;
  for (int c = std::fgetc(output); c != EOF && c != '\n'; c = std::fgetc(output)) {
    text += static_cast<char>(c);
  }
  EXPECT_EQ(::pclose(output), 0);
  return text;
}

TEST(CommandLine, PrintsACompletionThatBashUnderstands) {
  ToolCommand tool;
  const std::string script = printed(tool.command, "--print-completion");
  EXPECT_EQ(completed(script, "tool d"), "drive");
  EXPECT_EQ(completed(script, "tool --"), "--help --all");
  EXPECT_EQ(completed(script, "tool drive --"), "--help --gear");
  EXPECT_EQ(completed(script, "tool drive --gear ''"), "low high");
  EXPECT_EQ(completed(script, "tool drive h"), "home");
  EXPECT_EQ(completed(script, "tool drive home h"), "");
  EXPECT_EQ(completed(script, "tool break w"), "wheel");
  EXPECT_EQ(completed(script, "tool repair g"), "glue") << "a name that stands for a number";
  EXPECT_EQ(completed(script, "tool repair --by ''"), "anna ben");
  EXPECT_EQ(parse(tool.command, {"repair", "weld", "--by", "carl"}), std::nullopt) << "a proposal";
}

}  // namespace
}  // namespace topogeo::command_line
