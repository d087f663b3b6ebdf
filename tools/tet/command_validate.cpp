// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet validate`: is each file what it claims to be?
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/failure.hpp"
#include "common/output.hpp"
#include "common/terminal_progress.hpp"
#include "common/tet_file.hpp"
#include "tet/command.hpp"
#include "tetfmt/mapped_file.hpp"
#include "tetfmt/validate.hpp"

namespace tetprep {
namespace {

using tetfmt::Level;

struct ValidateOptions {
  std::vector<std::string> files;
  Level level = Level::geometry;
  bool json = false;
};

constexpr std::size_t kTextExamples = 3;

enum class Verdict { valid, unsupported, invalid, unreadable };  // worst last

struct FileReport {
  std::string path;
  Verdict verdict = Verdict::valid;
  tetfmt::Report report;

  std::uint64_t problems() const {
    std::uint64_t sum = 0;
    for (const auto& [code, group] : report.issues) sum += group.count;
    return sum;
  }
};

/// What reports call it: a file that this version cannot judge is not valid, and its issues say why.
const char* verdict_name(Verdict verdict) {
  constexpr std::array<const char*, 4> kNames = {"valid", "invalid", "invalid", "unreadable"};
  return kNames[static_cast<std::size_t>(verdict)];
}

/// Every problem is one that a newer version may not have.
bool only_unsupported(const tetfmt::Report& report) {
  return std::all_of(report.issues.begin(), report.issues.end(),
                     [](const auto& issue) { return is_unsupported(issue.first); });
}

FileReport examine(const std::string& path, Level level) {
  FileReport result{path, Verdict::valid, {}};
  const auto file = tetfmt::MappedFile::open(path);
  if (file) {
    result.report = tetfmt::validate(file->bytes(), level);
    result.verdict = result.report.valid()             ? Verdict::valid
                     : only_unsupported(result.report) ? Verdict::unsupported
                                                       : Verdict::invalid;
  } else {
    result.report.issues[file.error().code] = {1, {file.error()}};
    result.verdict = Verdict::unreadable;
  }
  return result;
}

std::string text_of(const FileReport& file) {
  std::string text;
  for (const auto& [code, group] : file.report.issues) {
    std::string line = file.path + ": " + std::to_string(static_cast<int>(code)) + " " +
                       tetfmt::code_name(code) + ", " + std::to_string(group.count) +
                       (group.count == 1 ? " time: " : " times: ") + tetfmt::code_meaning(code);
    const std::size_t shown = std::min(kTextExamples, group.examples.size());
    for (std::size_t i = 0; i < shown; ++i) {
      line += (i == 0 ? "; at " : ", at ") + std::to_string(group.examples[i].where) + " (" +
              group.examples[i].text + ")";
    }
    if (shown < group.count) line += ", ...";
    text += one_line(line) + "\n";
  }
  return text;
}

nlohmann::ordered_json json_of(const FileReport& file, Level requested) {
  nlohmann::ordered_json issues = nlohmann::ordered_json::array();
  for (const auto& [code, group] : file.report.issues) {
    nlohmann::ordered_json examples = nlohmann::ordered_json::array();
    for (const tetfmt::Error& example : group.examples) {
      examples.push_back({{"where", example.where}, {"text", example.text}});
    }
    issues.push_back({{"code", static_cast<int>(code)},
                      {"name", tetfmt::code_name(code)},
                      {"level", tetfmt::level_name(tetfmt::code_level(code))},
                      {"meaning", tetfmt::code_meaning(code)},
                      {"count", group.count},
                      {"examples", examples}});
  }
  nlohmann::ordered_json entry = {{"path", file.path},
                                  {"verdict", verdict_name(file.verdict)},
                                  {"requested_level", tetfmt::level_name(requested)}};
  entry["reached_level"] = file.verdict == Verdict::unreadable
                               ? nlohmann::ordered_json(nullptr)
                               : nlohmann::ordered_json(tetfmt::level_name(file.report.level));
  entry["problems"] = file.problems();
  entry["issues"] = issues;
  return entry;
}

/// The line on standard error that says what to do.
std::string advice(const FileReport& file) {
  if (file.verdict == Verdict::unreadable) {
    return file.report.issues.begin()->second.examples.front().text +  // names the file
           "; check the path and its permissions";
  }
  if (file.verdict == Verdict::unsupported) {
    const auto& [code, group] = *file.report.issues.begin();
    return file.path + ": unsupported: " + tetfmt::code_meaning(code) + "; a newer `tet` may read it";
  }
  const std::size_t codes = file.report.issues.size();
  return file.path + ": invalid: " + std::to_string(file.problems()) +
         (file.problems() == 1 ? " problem of " : " problems of ") + std::to_string(codes) +
         (codes == 1 ? " code" : " codes") + ", examined up to level " +
         tetfmt::level_name(file.report.level) + "; copy or convert it again";
}

int run_validate(const ValidateOptions& options) {
  Verdict worst = Verdict::valid;
  nlohmann::ordered_json files = nlohmann::ordered_json::array();
  for (const std::string& path : options.files) {
    FileReport file;
    {
      TerminalProgress progress;
      progress.stage("validate " + path);
      file = examine(path, options.level);
    }
    worst = std::max(worst, file.verdict);
    if (options.json) {
      files.push_back(json_of(file, options.level));
    } else if (file.verdict == Verdict::invalid || file.verdict == Verdict::unsupported) {
      Output::standard().write(text_of(file));
    }
    if (file.verdict != Verdict::valid) std::cerr << "tet validate: " << one_line(advice(file)) << '\n';
  }
  if (options.json) {
    const nlohmann::ordered_json report = {
        {"report", "tet validate"}, {"version", 1}, {"verdict", verdict_name(worst)}, {"files", files}};
    // File names need not be UTF-8: what is not becomes U+FFFD.
    Output::standard().write(report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  }
  switch (worst) {
    case Verdict::valid:
      return static_cast<int>(ExitCode::ok);
    case Verdict::unsupported:
      return static_cast<int>(ExitCode::unsupported);
    case Verdict::invalid:
      return static_cast<int>(ExitCode::invalid);
    case Verdict::unreadable:
      break;
  }
  return static_cast<int>(ExitCode::io);
}

}  // namespace

void add_validate_command(CLI::App& app, std::function<int()>& run) {
  const auto options = std::make_shared<ValidateOptions>();
  CLI::App* verb = app.add_subcommand(
      "validate",
      "Prove that tet files are what they claim to be, or say what is wrong. Silent when all is well.");
  verb->add_option("FILE", options->files, "Tet files to examine")->required();
  const std::map<std::string, Level> levels{{"structure", Level::structure},
                                            {"checksum", Level::checksum},
                                            {"topology", Level::topology},
                                            {"geometry", Level::geometry}};
  verb->add_option_function<std::string>(
          "--level", [options, levels](const std::string& name) { options->level = levels.at(name); },
          "How deep to look; each level includes those before it [geometry]:\n"
          "structure: header, table of contents, lengths, padding\n"
          "checksum:  every stored byte against its hash\n"
          "topology:  every tetrahedron, reference and side\n"
          "geometry:  exact orientation, convexity, covering of the input triangles")
      ->check(one_of({"structure", "checksum", "topology", "geometry"}))
      ->type_name("LEVEL");
  verb->add_option_function<std::string>(
          "--format", [options](const std::string& name) { options->json = name == "json"; },
          "text: a line for each code and file, with number, name, count, meaning and the first examples;\n"
          "json: one object, also when all is well; spec/validate.schema.json describes it [text]")
      ->check(one_of({"text", "json"}))
      ->type_name("FORMAT");
  verb->footer(
      "Findings go to standard output, one line of advice for each bad file to standard error. Places are "
      "byte\n"
      "offsets for codes 2xxx, element numbers from 4xxx on; spec/issues.md explains each code.\n"
      "The verdict counts every problem, whether it is printed or not.\n"
      "\n"
      "Exit codes: 0 all files are valid; 5 a file is of a kind that this version does not know, otherwise "
      "all is\n"
      "well; 3 a file is invalid; 2 a file cannot be read (2 wins over 3, 3 over 5); 1 usage.\n"
      "\n"
      "Examples:\n"
      "  tet validate bunny.tet && echo sound\n"
      "  tet validate --level checksum *.tet\n"
      "  tet validate --format json bunny.tet");
  verb->callback([options, &run] { run = [options] { return run_validate(*options); }; });
}

}  // namespace tetprep
