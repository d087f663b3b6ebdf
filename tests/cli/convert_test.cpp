// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet convert` as people and scripts meet it: options, batches, signals, what it shows meanwhile.
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "cli/cli_support.hpp"

namespace tetfmt_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// An axis-aligned cube as OBJ text; `first` is the number of its first vertex.
std::string cube_obj(double low, double high, int first = 1) {
  std::ostringstream text;
  for (int i = 0; i < 8; ++i)
    text << "v " << (i & 1 ? high : low) << ' ' << (i & 2 ? high : low) << ' ' << (i & 4 ? high : low)
         << '\n';
  constexpr int kQuads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& quad : kQuads) {
    text << 'f';
    for (const int corner : quad) text << ' ' << corner + first;
    text << '\n';
  }
  return text.str();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, '\t');) fields.push_back(field);
  return fields;
}

json report_of(const std::string& path) {
  return json::parse(read_bytes(path));
}

class CliConvert : public CliTest {
 protected:
  /// A surface that keeps TetGen busy for some seconds.
  static void write_busy() {
    ASSERT_EQ(tet({"sample", "knots", "-o", "busy.ply", "--triangles", "60000"}).exit_code, 0);
  }
};

TEST_F(CliConvert, HelpTeaches) {
  const RunResult help = tet({"convert", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_EQ(help.err, "");
  for (const std::string part : {"INPUT",
                                 "--output",
                                 "--report",
                                 "--debug-mesh",
                                 "--layout",
                                 "--attributes",
                                 "--surface",
                                 "--keep",
                                 "reachable-from X,Y,Z",
                                 "--simplify",
                                 "--timeout",
                                 "--memory",
                                 "--batch",
                                 "--jobs",
                                 "--threads",
                                 "--optimize",
                                 "--radius-edge",
                                 "Exit codes: 0",
                                 "Examples:\n  tet convert ",
                                 ".glb",
                                 ".obj"})
    EXPECT_NE(help.out.find(part), std::string::npos) << part;
  EXPECT_EQ(help.out.find("--time-limit"), std::string::npos) << "an old name, for old scripts only";
}

TEST_F(CliConvert, WrongCommandLines) {
  write_bytes("a.obj", cube_obj(0, 1));
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"a.obj"},
      {"-o", "x.tet"},
      {"a.obj", "-o", "x.tet", "--layout", "tet18"},
      {"a.obj", "-o", "x.tet", "--attributes", "some"},
      {"a.obj", "-o", "x.tet", "--surface", "zip"},
      {"a.obj", "-o", "x.tet", "--keep", "inside"},
      {"a.obj", "-o", "x.tet", "--keep"},
      {"a.obj", "-o", "x.tet", "--keep", "reachable-from"},
      {"a.obj", "-o", "x.tet", "--keep", "reachable-from", "1,2"},
      {"a.obj", "-o", "x.tet", "--keep", "reachable-from", "1,2,nan"},
      {"a.obj", "-o", "x.tet", "--keep", "outside", "--keep", "all"},
      {"a.obj", "-o", "x.tet", "--timeout", "0"},
      {"a.obj", "-o", "x.tet", "--timeout", "inf"},
      {"a.obj", "-o", "x.tet", "--time-limit", "-1"},
      {"a.obj", "-o", "x.tet", "--memory", "4X"},
      {"a.obj", "-o", "x.tet", "--memory", "-4G"},
      {"a.obj", "-o", "x.tet", "--memory", "0"},
      {"a.obj", "-o", "x.tet", "--simplify", "0"},
      {"a.obj", "-o", "x.tet", "--radius-edge", "0.5"},
      {"a.obj", "-o", "x.tet", "--threads", "0"},
      {"a.obj", "-o", "x.tet", "-j", "2"},
      {"a.obj", "-o", "x.tet", "-q", "-v"},
      {"a.obj", "--batch", "list"},
      {"--batch", "list", "--debug-mesh", "d.ply"},
      {"a.obj", "-o", "a.obj"},
      {"a.obj", "-o", "x.tet", "--debug-mesh", "x.tet"},
      {"a.obj", "-o", "x.tet", "--debug-mesh", "a.obj"},
  };
  for (auto arguments : wrong) {
    arguments.insert(arguments.begin(), "convert");
    std::string line;
    for (const std::string& argument : arguments) line += " " + argument;
    const RunResult result = tet(arguments);
    EXPECT_EQ(result.exit_code, 1) << line << '\n' << result.err;
    EXPECT_TRUE(is_one_line(result.err, "tet convert", {})) << line;
    EXPECT_EQ(listing(), std::vector<std::string>{"a.obj"}) << line;
  }
  const RunResult choice = tet({"convert", "a.obj", "-o", "x.tet", "--optimize", "most"});
  EXPECT_TRUE(is_one_line(choice.err, "tet convert", {"--optimize", "must be none, fast or best, not most"}));
}

TEST_F(CliConvert, KeepTakesAPointOrNone) {
  write_bytes("out.obj", cube_obj(0, 8));
  write_bytes("in.obj", cube_obj(3, 5));
  // The word after `outside` is an input, wherever it stands.
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--keep", "outside", "out.obj", "in.obj"},
        {"out.obj", "--keep", "outside", "in.obj"},
        {"out.obj", "in.obj", "--keep", "outside"},
        {"out.obj", "in.obj", "--keep=outside"}}) {
    std::vector<std::string> arguments{"convert", "-q", "-o", "x.tet", "--report", "r.json"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const RunResult result = tet(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json report = report_of("r.json");
    EXPECT_EQ(report["inputs"], (json{"out.obj", "in.obj"}));
    EXPECT_EQ(report["options"]["keep"], "outside");
    EXPECT_EQ(report["regions"]["count"], 3);
    EXPECT_EQ(report["regions"]["kept"], 1);
  }
  const auto kept = [&](const std::vector<std::string>& points) {
    std::vector<std::string> arguments{"convert", "-q",    "out.obj",  "in.obj",
                                       "-o",      "x.tet", "--report", "r.json"};
    for (const std::string& point : points)
      arguments.insert(arguments.end(), {"--keep", "reachable-from", point});
    const RunResult result = tet(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(tet({"validate", "x.tet"}).exit_code, 0);
    const json report = report_of("r.json");
    return std::pair{report["regions"]["kept"].get<int>(), report["result"]["tets"].get<int>()};
  };
  const auto [one, inner] = kept({"4,4,4"});
  const auto [other, shell] = kept({"1,1,1"});
  const auto [two, both] = kept({"4,4,4", "1,1,1"});
  EXPECT_EQ(one, 1);
  EXPECT_EQ(other, 1);
  EXPECT_EQ(two, 2);
  EXPECT_EQ(both, inner + shell);
  EXPECT_EQ(kept({"-0.1,4,4"}).first, 1) << "a negative coordinate is no option";

  const RunResult outside = tet({"convert", "out.obj", "-o", "y.tet", "--keep", "reachable-from", "100,0,0"});
  EXPECT_EQ(outside.exit_code, 1);
  EXPECT_TRUE(is_one_line(outside.err, "tet convert", {"100,0,0", "outside of the box"}));
  EXPECT_FALSE(fs::exists("y.tet"));
}

TEST_F(CliConvert, NothingToLeaveOutIsSaid) {
  write_bytes("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const RunResult result = tet({"convert", "open.obj", "-o", "x.tet", "--keep", "outside"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.err.find("nothing could be left out: the surface closes no space off"), std::string::npos)
      << result.err;
}

TEST_F(CliConvert, IntersectionsAreCut) {
  write_bytes("x.obj", cube_obj(0, 8) + cube_obj(4, 12, 9));
  const RunResult result =
      tet({"convert", "x.obj", "-o", "x.tet", "--report", "r.json", "--debug-mesh", "d.ply"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("pairs of triangles met"), std::string::npos) << result.err;
  EXPECT_EQ(tet({"validate", "x.tet"}).exit_code, 0);
  const json report = report_of("r.json");
  EXPECT_EQ(report["outcome"], "ok (cut)");
  EXPECT_GT(report["resolve"]["intersecting_pairs"], 5);
  EXPECT_EQ(report["intersection_count"], report["resolve"]["intersecting_pairs"]);
  EXPECT_GE(report["resolve"]["cut_triangles"], 6);
  EXPECT_GT(report["surface"]["triangles"], 24);
  EXPECT_EQ(report["regions"]["count"], 4);  // around, two that are one cube's alone, and both cubes'
  EXPECT_TRUE(read_bytes("d.ply").starts_with("ply\n"));
}

TEST_F(CliConvert, TimeAndMemoryAreLimited) {
  write_busy();
  const RunResult slow = tet({"convert", "busy.ply", "-o", "x.tet", "--timeout", "0.01"});
  EXPECT_EQ(slow.exit_code, 4);
  EXPECT_TRUE(is_one_line(slow.err, "tet convert", {"busy.ply", "TetGen"}));
  const RunResult fat = tet({"convert", "busy.ply", "-o", "x.tet", "--memory", "16M"});
  EXPECT_EQ(fat.exit_code, 4);
  EXPECT_TRUE(is_one_line(fat.err, "tet convert", {"busy.ply", "memory"}));
  EXPECT_EQ(listing(), std::vector<std::string>{"busy.ply"});
}

// ---- batches

TEST_F(CliConvert, BatchGoesOnAfterFailures) {
  fs::create_directory("out");
  fs::create_directory("models");
  write_bytes("models/a.obj", cube_obj(0, 1));
  write_bytes("models/with blank.obj", cube_obj(0, 2));
  write_bytes("models/flat.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n");
  write_bytes("list",
              "# what to convert\n"
              "models/a.obj\n"
              "\n"
              "models/missing.obj\n"
              "  models/flat.obj\r\n"
              "models/with blank.obj\tnamed.tet\n"
              "models/a.obj\tmodels/with blank.obj\ttwo.tet");
  for (const std::string jobs : {"1", "3"}) {
    const RunResult result =
        tet({"convert", "--batch", "list", "-o", "out", "-j", jobs, "--report", "r.json"});
    EXPECT_EQ(result.exit_code, 2) << "the first failure in the list is a missing file";
    const auto errors = lines_of(result.err);
    EXPECT_EQ(errors.size(), 2u) << result.err;
    const auto table = lines_of(result.out);
    ASSERT_EQ(table.size(), 6u) << result.out;
    EXPECT_EQ(table[0], "file\ttriangles\toutcome\tseconds\tmemory_mb\ttets\tdetail");
    const std::vector<std::array<std::string, 4>> expected = {
        {"models/a.obj", "12", "ok", "out/a.tet"},
        {"models/missing.obj", "0", "io", ""},
        {"models/flat.obj", "1", "invalid", ""},
        {"models/with blank.obj", "12", "ok", "named.tet"},
        {"models/a.obj + models/with blank.obj", "24", "ok (cut)", "two.tet"}};
    const json report = report_of("r.json");
    EXPECT_EQ(report["conversions"], 5);
    EXPECT_EQ(report["failed"], 2);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const auto fields = fields_of(table[i + 1]);
      ASSERT_EQ(fields.size(), 7u) << table[i + 1];
      EXPECT_EQ(fields[0], expected[i][0]);
      EXPECT_EQ(fields[1], expected[i][1]);
      EXPECT_EQ(fields[2], expected[i][2]);
      if (!expected[i][3].empty()) {
        EXPECT_EQ(fields[6], expected[i][3]);
        EXPECT_EQ(tet({"validate", fields[6]}).exit_code, 0);
      }
      EXPECT_EQ(report["jobs"][i]["outcome"], expected[i][2]);
      EXPECT_EQ(std::to_string(report["jobs"][i]["result"]["tets"].get<int>()), fields[5]);
    }
    for (const std::string path : {"out/a.tet", "named.tet", "two.tet", "r.json"})
      EXPECT_TRUE(fs::remove(path)) << path;
    EXPECT_EQ(listing(), (std::vector<std::string>{"list", "models", "out"}));
    EXPECT_TRUE(fs::is_empty("out"));
  }
}

TEST_F(CliConvert, BatchFromStandardInputWritesBesideTheInput) {
  write_bytes("a.obj", cube_obj(0, 1));
  write_bytes("b.obj", cube_obj(0, 1));
  const RunResult result = tet({"convert", "--batch", "-", "-q", "--layout", "tet16"}, "a.obj\nb.obj\n");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(listing(), (std::vector<std::string>{"a.obj", "a.tet", "b.obj", "b.tet"}));
  EXPECT_EQ(read_bytes("a.tet"), read_bytes("b.tet"));
  EXPECT_EQ(tet({"convert", "a.obj", "-o", "c.tet", "-q", "--layout", "tet16"}).exit_code, 0);
  EXPECT_EQ(read_bytes("a.tet"), read_bytes("c.tet"));
}

TEST_F(CliConvert, BadListsAreRefusedBeforeAnything) {
  write_bytes("a.obj", cube_obj(0, 1));
  const std::vector<std::pair<std::string, std::string>> lists = {
      {"a.obj\nb.obj\ta.tet\n", "standard input:2: writes a.tet, as line 1 does"},
      {"a.obj\n./a.off\n", "standard input:2: writes ./a.tet, as line 1 does"},
      {"a.obj\tb.obj\nb.obj\tc.tet\n", "standard input:2: reads b.obj, which line 1 writes"},
      {"a.obj\t\tx.tet\n", "standard input:1: an empty field"},
      {"\n# nothing\n", "no conversions"},
      {"", "no conversions"}};
  for (const auto& [list, message] : lists) {
    const RunResult result = tet({"convert", "--batch", "-"}, list);
    EXPECT_EQ(result.exit_code, 3) << list;
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(is_one_line(result.err, "tet convert", {message})) << list;
    EXPECT_EQ(listing(), std::vector<std::string>{"a.obj"});
  }
  EXPECT_EQ(tet({"convert", "--batch", "-", "--report", "a.obj"}, "a.obj\n").exit_code, 1);
  EXPECT_EQ(tet({"convert", "--batch", "-", "--report", "a.tet"}, "a.obj\n").exit_code, 1);
  EXPECT_EQ(tet({"convert", "--batch", "missing"}).exit_code, 2);
  EXPECT_EQ(tet({"convert", "--batch", "."}).exit_code, 2);
  EXPECT_EQ(tet({"convert", "--batch", "-", "-o", "missing"}, "a.obj\n").exit_code, 2);
  EXPECT_EQ(listing(), std::vector<std::string>{"a.obj"});
}

// ---- signals

/// Processes whose parent is `parent`.
std::vector<pid_t> children_of(pid_t parent) {
  std::ifstream file("/proc/" + std::to_string(parent) + "/task/" + std::to_string(parent) + "/children");
  std::vector<pid_t> children;
  for (pid_t child = 0; file >> child;) children.push_back(child);
  return children;
}

bool eventually(const std::function<bool()>& condition) {
  for (int i = 0; i < 3000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// Gone, or a zombie that only waits for whoever adopts orphans here.
bool has_ended(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto name_end = text.rfind(')');
  return name_end == std::string::npos || text.at(name_end + 2) == 'Z' || text.at(name_end + 2) == 'X';
}

/// Starts `tet`, its streams to nowhere.
pid_t start(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), TET_BINARY);
  std::vector<char*> words;
  for (std::string& word : arguments) words.push_back(word.data());
  words.push_back(nullptr);
  const pid_t child = fork();
  if (child != 0) return child;
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int descriptor : {0, 1, 2}) dup2(nowhere, descriptor);
  execv(words[0], words.data());
  _exit(127);
}

TEST_F(CliConvert, InterruptsDuringTetgenLeaveNothing) {
  write_busy();
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const pid_t convert = start({"convert", "busy.ply", "-o", "x.tet", "--report", "r.json"});
    ASSERT_TRUE(eventually([&] { return !children_of(convert).empty(); }));
    const std::vector<pid_t> tetgen = children_of(convert);
    EXPECT_GT(listing().size(), 1u) << "temporaries are what this is about";
    kill(convert, signal);
    int status = 0;
    waitpid(convert, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
    for (const pid_t child : tetgen) EXPECT_TRUE(eventually([&] { return has_ended(child); }));
    EXPECT_EQ(listing(), std::vector<std::string>{"busy.ply"});
  }
}

TEST_F(CliConvert, InterruptedBatchesLeaveNothing) {
  write_busy();
  write_bytes("list", "busy.ply\ta.tet\nbusy.ply\tb.tet\nbusy.ply\tc.tet\n");
  for (const int signal : {SIGINT, SIGTERM}) {
    const pid_t batch = start({"convert", "--batch", "list", "-j", "2", "--report", "r.json"});
    std::vector<pid_t> below;
    ASSERT_TRUE(eventually([&] {
      below = children_of(batch);
      std::size_t deep = 0;
      for (const pid_t child : std::vector<pid_t>(below)) {
        const auto tetgen = children_of(child);
        deep += !tetgen.empty();
        below.insert(below.end(), tetgen.begin(), tetgen.end());
      }
      return deep == 2;
    }));
    kill(batch, signal);
    int status = 0;
    waitpid(batch, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << status;
    for (const pid_t child : below) EXPECT_TRUE(eventually([&] { return has_ended(child); }));
    // The third conversion may have begun in the meantime, and takes as long to end as the others.
    const std::vector<std::string> inputs = {"busy.ply", "list"};
    EXPECT_TRUE(eventually([&] { return listing() == inputs; })) << listing().size();
  }
}

TEST_F(CliConvert, BatchOutlivesAConversionThatDies) {
  write_busy();
  write_bytes("a.obj", cube_obj(0, 1));
  write_bytes("list", "busy.ply\na.obj\n");
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t batch = fork();
  if (batch == 0) {
    dup2(ends[1], 1);
    dup2(open("/dev/null", O_WRONLY), 2);
    execl(TET_BINARY, "tet", "convert", "--batch", "list", nullptr);
    _exit(127);
  }
  close(ends[1]);
  std::vector<pid_t> conversions;
  ASSERT_TRUE(eventually([&] {
    conversions = children_of(batch);
    return !conversions.empty() && !children_of(conversions.front()).empty();
  }));
  kill(conversions.front(), SIGKILL);
  int status = 0;
  waitpid(batch, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 4);
  std::string out(4096, '\0');
  out.resize(static_cast<std::size_t>(std::max<ssize_t>(read(ends[0], out.data(), out.size()), 0)));
  close(ends[0]);
  const auto table = lines_of(out);
  ASSERT_EQ(table.size(), 3u) << out;
  EXPECT_NE(table[1].find("\truntime\t"), std::string::npos) << out;
  EXPECT_NE(table[1].find("Killed"), std::string::npos) << out;
  EXPECT_NE(table[2].find("a.obj\t12\tok\t"), std::string::npos) << out;
}

// ---- what is shown meanwhile

/// Runs `tet` with standard error on a terminal; returns what the terminal got.
std::string on_terminal(std::vector<std::string> arguments) {
  const int master = posix_openpt(O_RDWR | O_NOCTTY);
  if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0) return {};
  const std::string name = ptsname(master);
  arguments.insert(arguments.begin(), TET_BINARY);
  std::vector<char*> words;
  for (std::string& word : arguments) words.push_back(word.data());
  words.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    dup2(open(name.c_str(), O_RDWR | O_NOCTTY), 2);
    execv(words[0], words.data());
    _exit(127);
  }
  std::string seen;
  int status = 0;
  bool running = true;
  fcntl(master, F_SETFL, O_NONBLOCK);
  while (running) {
    running = waitpid(child, &status, WNOHANG) == 0;
    char part[4096];
    for (ssize_t size; (size = read(master, part, sizeof part)) > 0;)
      seen.append(part, static_cast<std::size_t>(size));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  close(master);
  EXPECT_EQ(WEXITSTATUS(status), 0) << seen;
  return seen;
}

TEST_F(CliConvert, TerminalsGetOneLineThatIsWiped) {
  write_busy();
  const std::string seen = on_terminal({"convert", "busy.ply", "-o", "x.tet"});
  EXPECT_NE(seen.find("\rread"), std::string::npos) << seen;
  EXPECT_NE(seen.find("\rtetgen: "), std::string::npos) << seen;
  const auto wiped = seen.rfind("\r\x1b[K");
  ASSERT_NE(wiped, std::string::npos);
  EXPECT_EQ(seen.find("x.tet: "), wiped + 4) << "the summary stands where the bar was";
  EXPECT_EQ(on_terminal({"convert", "busy.ply", "-o", "x.tet", "-q"}), "");
}

TEST_F(CliConvert, ElsewhereVerboseSaysALineAStage) {
  write_bytes("a.obj", cube_obj(0, 1));
  const RunResult quiet = tet({"convert", "a.obj", "-o", "x.tet", "-q"});
  EXPECT_EQ(quiet.err, "");
  const RunResult plain = tet({"convert", "a.obj", "-o", "x.tet"});
  EXPECT_EQ(lines_of(plain.err).size(), 1u) << plain.err;
  const RunResult verbose = tet({"convert", "a.obj", "-o", "x.tet", "-v"});
  EXPECT_EQ(verbose.err.find('\r'), std::string::npos);
  for (const char* stage : {" s  read\n", " s  snap\n", " s  tetgen: delaunay\n", " s  validate\n"})
    EXPECT_NE(verbose.err.find(stage), std::string::npos) << stage;
}

}  // namespace
}  // namespace tetfmt_test
