// SPDX-License-Identifier: AGPL-3.0-or-later
// One verb of `tet` is one file, command_<verb>.cpp, and one function of this form: it adds a subcommand with
// its options and help to `app`, and has the subcommand's callback put the work into `run`. main() parses,
// then calls `run`, whose value is the exit code. Options live in a shared_ptr that both lambdas hold.
//
// Work ends with an exit code, or with tetprep::Failure for a problem that one line can tell; main() prints
// that line. Data goes to standard output by Output (common/output.hpp), everything else to standard error.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace tetprep {

/// Checks that an option is one of `names`, and tells in plain words when it is not.
inline CLI::Validator one_of(const std::vector<std::string>& names) {
  std::string choices;
  for (std::size_t i = 0; i < names.size(); ++i)
    choices += (i == 0 ? "" : i + 1 < names.size() ? ", " : " or ") + names[i];
  return {[names, choices](const std::string& text) {
            for (const std::string& name : names)
              if (text == name) return std::string();
            return "must be " + choices + ", not " + text;
          },
          choices};
}

/// Adds an option that sets `value` by a name.
template <class Value>
CLI::Option* add_choice(CLI::App& app, const std::string& option, Value& value,
                        const std::vector<std::pair<std::string, Value>>& choices,
                        const std::string& description) {
  std::vector<std::string> names;
  for (const auto& choice : choices) names.push_back(choice.first);
  const auto set = [&value, choices](const std::string& text) {
    for (const auto& [name, meaning] : choices)
      if (text == name) value = meaning;
  };
  return app.add_option_function<std::string>(option, set, description)->check(one_of(names));
}

void add_convert_command(CLI::App& app, std::function<int()>& run);
void add_validate_command(CLI::App& app, std::function<int()>& run);
void add_extract_command(CLI::App& app, std::function<int()>& run);
void add_info_command(CLI::App& app, std::function<int()>& run);
void add_trace_command(CLI::App& app, std::function<int()>& run);
void add_query_command(CLI::App& app, std::function<int()>& run);
void add_sample_command(CLI::App& app, std::function<int()>& run);
void add_bench_command(CLI::App& app, std::function<int()>& run);

}  // namespace tetprep
