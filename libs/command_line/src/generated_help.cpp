#include "generated_help.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "topogeo/command_line/command_line.hpp"

namespace topogeo::command_line {

namespace {

/// The options of a command with those of its groups, in the order of their declaration.
std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  std::vector<const CLI::Option*> options = app.get_options();
  for (const CLI::App* group : app.get_subcommands(nullptr)) {
    if (!group->get_name().empty()) continue;
    const std::vector<const CLI::Option*> more = options_of(*group);
    options.insert(options.end(), more.begin(), more.end());
  }
  return options;
}

std::vector<const CLI::App*> subcommands_of(const CLI::App& app) {
  std::vector<const CLI::App*> commands = app.get_subcommands(nullptr);
  std::erase_if(commands, [](const CLI::App* command) { return command->get_name().empty(); });
  return commands;
}

/// Text that man(7) prints unchanged: hyphens that can be copied, no requests.
std::string escaped(std::string_view text) {
  std::string result;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
    line_begins = c == '\n';
  }
  return result;
}

/// CLI11 appends the check to the name of a type: "UINT:UINT in [0 - 256]".
struct Value {
  std::string name;
  std::string check;
};

Value value_of(const CLI::Option& option) {
  const std::string text = option.get_type_name();
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return {text, ""};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

/// The members of a check "{mild,b21,none}".
std::vector<std::string> members_of(const CLI::Option& option) {
  const std::string check = value_of(option).check;
  std::vector<std::string> members;
  if (check.size() < 2 || check.front() != '{' || check.back() != '}') return members;
  std::string member;
  for (const char c : std::string_view(check).substr(1)) {
    if (c != ',' && c != '}') {
      member += c;
    } else {
      members.push_back(std::move(member));
      member.clear();
    }
  }
  return members;
}

std::string names_of(const CLI::Option& option) {
  std::string flags = option.get_name(false, true);
  if (!option.get_positional()) return flags;
  const std::string positional = option.get_name(true);
  return flags == positional ? positional : positional + ", " + flags;
}

void append_option(std::string& page, const CLI::Option& option) {
  const Value value = value_of(option);
  page += ".TP\n.B " + escaped(names_of(option));
  const bool is_flag = option.get_items_expected_max() == 0;
  if (!is_flag && !value.name.empty()) page += " \\fI" + escaped(value.name) + "\\fR";
  page += '\n';
  std::string text = option.get_description();
  if (option.get_required()) text += " (required)";
  if (!is_flag && !value.check.empty()) text += " (" + value.check + ")";
  if (!option.get_default_str().empty()) text += " (default: " + option.get_default_str() + ")";
  page += (text.empty() ? std::string("\\&") : escaped(text)) + '\n';
}

void append_command(std::string& page, const CLI::App& app, const std::string& path) {
  page += ".SS " + escaped(path) + '\n' + escaped(app.get_description()) + '\n';
  for (const CLI::Option* option : options_of(app)) {
    if (option->get_name() != "--help") append_option(page, *option);
  }
  if (const std::string footer = app.get_footer(); !footer.empty()) {
    page += ".PP\n" + escaped(footer) + '\n';
  }
  for (const CLI::App* command : subcommands_of(app)) {
    append_command(page, *command, path + ' ' + command->get_name());
  }
}

/// The page up to the options. `title`: name of the page; `usage`: words to type.
std::string page_head(const CLI::App& app, const std::string& title, const std::string& usage,
                      bool has_commands) {
  std::string capitals = title;
  std::ranges::transform(capitals, capitals.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  std::string summary = app.get_description();
  summary = summary.substr(0, summary.find(". "));
  if (summary.ends_with('.')) summary.pop_back();
  std::string page = ".TH " + escaped(capitals) + " 1 \"\" topogeo \"User commands\"\n.SH NAME\n" +
                     escaped(title) + " \\- " + escaped(summary) + "\n.SH SYNOPSIS\n.B " +
                     escaped(usage) + "\n[\\fIOPTION\\fR]...";
  page += has_commands ? " \\fICOMMAND\\fR [\\fIOPTION\\fR]...\n" : "\n";
  page += ".SH DESCRIPTION\n" + escaped(app.get_description()) + "\n.SH OPTIONS\n";
  for (const CLI::Option* option : options_of(app)) append_option(page, *option);
  return page;
}

void append_case(std::string& script, const CLI::App& app, const std::string& path,
                 const WordsOf& words_of) {
  std::string options;
  std::string commands;
  std::string values;
  for (const CLI::Option* option : options_of(app)) {
    std::string names;
    for (const std::string& name : option->get_lnames()) {
      options += " --" + name;
      names += (names.empty() ? "--" : " | --") + name;
    }
    std::string list;
    for (const std::string& member : members_of(*option)) list += ' ' + member;
    for (const std::string& word : words_of(*option)) list += ' ' + word;
    if (option->get_positional()) commands += list;
    if (names.empty()) continue;
    if (!list.empty()) values += "        " + names + ") values='" + list.substr(1) + "' ;;\n";
  }
  const std::vector<const CLI::App*> parts = subcommands_of(app);
  for (const CLI::App* command : parts) commands += ' ' + command->get_name();
  script += "    '" + path + "')\n      options='" + options + "' commands='" + commands + "'\n";
  if (!values.empty()) script += "      case $previous in\n" + values + "      esac\n";
  script += "      ;;\n";
  for (const CLI::App* command : parts) {
    append_case(script, *command, path + ' ' + command->get_name(), words_of);
  }
}

}  // namespace

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : subcommands_of(app)) names.push_back(command->get_name());
  return names;
}

std::string manual_page(const CLI::App& app) {
  const std::string& name = app.get_name();
  const std::vector<const CLI::App*> commands = subcommands_of(app);
  std::string page = page_head(app, name, name, !commands.empty());
  if (!commands.empty()) page += ".SH COMMANDS\n";
  for (const CLI::App* command : commands) {
    page += ".TP\n.BR " + escaped(name + '-' + command->get_name()) + " (1)\n" +
            escaped(command->get_description()) + '\n';
  }
  if (const std::string footer = app.get_footer(); !footer.empty()) {
    page += ".SH NOTES\n" + escaped(footer) + '\n';
  }
  return page;
}

std::string manual_page(const CLI::App& app, const std::string& command) {
  const std::vector<const CLI::App*> commands = subcommands_of(app);
  const auto found = std::ranges::find(commands, command, &CLI::App::get_name);
  if (found == commands.end()) {
    throw UsageError("--print-manual: expected a command, got '" + command + "'");
  }
  const CLI::App& one = **found;
  const std::vector<const CLI::App*> parts = subcommands_of(one);
  const std::string path = app.get_name() + ' ' + command;
  std::string page = page_head(one, app.get_name() + '-' + command, path, !parts.empty());
  if (!parts.empty()) page += ".SH COMMANDS\n";
  for (const CLI::App* part : parts) append_command(page, *part, path + ' ' + part->get_name());
  if (const std::string footer = one.get_footer(); !footer.empty()) {
    page += ".SH NOTES\n" + escaped(footer) + '\n';
  }
  return page + ".SH SEE ALSO\n.BR " + escaped(app.get_name()) + " (1)\n";
}

std::string bash_completion(const CLI::App& app, const WordsOf& words_of) {
  const std::string& name = app.get_name();
  std::string script = "# Completion of " + name + " in bash, made by " + name +
                       " --print-completion.\n_" + name + R"(() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
  local path='' options='' commands='' values='' word
  # The subcommands that are typed already; a word that is the value of an option is taken for one
  # only where it has its name.
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    _)" + name + R"(_words "$path"
    case " $commands " in *" $word "*) path+=" $word" ;; esac
  done
  _)" + name + R"(_words "$path"
  if [[ -n $values ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$values" -- "$current")
  elif [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
  elif [[ -n $commands ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$commands" -- "$current")
  else
    COMPREPLY=()
  fi
}
# Sets what can follow: options, commands, values.
_)" + name + R"(_words() {
  options='' commands='' values=''
  case $1 in
)";
  append_case(script, app, "", words_of);
  script += "  esac\n}\ncomplete -o default -F _" + name + ' ' + name + '\n';
  return script;
}

}  // namespace topogeo::command_line
