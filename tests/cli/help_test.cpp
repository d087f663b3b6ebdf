// SPDX-License-Identifier: AGPL-3.0-or-later
// The command line itself: help, version, usage errors, and what holds for every verb.
#include <map>

#include "cli/cli_support.hpp"
#include "tetfmt/version.hpp"

namespace tetfmt_test {
namespace {

TEST_F(CliTest, HelpListsVerbsAndExitCodes) {
  const RunResult result = tet({"--help"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  for (const char* part : {"convert", "validate", "info", "trace", "query", "sample", "bench", "Exit codes",
                           "  0  ", "  1  ", "  2  ", "  3  ", "  4  ", "  5  ", "  7  ", "Examples"}) {
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
  }
}

TEST_F(CliTest, EveryVerbsHelpTeaches) {
  const std::map<std::string, std::vector<std::string>> options = {
      {"validate",
       {"FILE", "--level", "--format", "structure", "checksum", "topology", "geometry", "json",
        "[geometry]"}},
      {"info", {"FILE", "--format", "json"}},
      {"trace",
       {"FILE",        "--output",  "--size",    "--eye",     "--look-at", "--up",  "--fov",      "--azimuth",
        "--elevation", "--shade",   "--samples", "--threads", "--kernel",  "exact", "float",      ".exr",
        ".json",       "\"files\"", "lambert",   "normal",    "depth",     "steps", "1024x1024]", "degrees"}},
      {"query",
       {"FILE", "--rays", "--hits", "--threads", "--space", "--kernel", ".npy", ".csv", "triangle",
        "neighbor", "local", "--answer", "blocked", "paths", "t_max"}},
      {"bench",
       {"FILE",        "--stress", "--rays",      "--sets",      "--seed",    "--threads",      "--csv",
        "--json",      "--quick",  "--tracers",   "--workloads", "--against", "--shuffled",     "--pictures",
        "tet20-exact", "kd-tree",  "camera-16.5", "ao-10",       "vertices",  "from-tet-edges", "parity",
        "bounces",     "segments", "denormal",    "[4000000]"}},
      {"sample",
       {"KIND", "--output", "--triangles", "--seed", "sphere", "torus-knot", "bumpy-plane", "knots", ".obj",
        ".off", ".ply", ".stl", "at least"}},
  };
  for (const auto& [verb, parts] : options) {
    const RunResult result = tet({verb, "--help"});
    EXPECT_EQ(result.exit_code, 0) << verb;
    EXPECT_EQ(result.err, "") << verb;
    for (const std::string& part : parts) {
      EXPECT_NE(result.out.find(part), std::string::npos) << verb << ": " << part;
    }
    EXPECT_NE(result.out.find("Exit codes: 0"), std::string::npos) << verb;
    EXPECT_NE(result.out.find("Examples:\n  "), std::string::npos) << verb;
    EXPECT_NE(result.out.find("tet " + verb + " "), std::string::npos) << verb;
  }
}

TEST_F(CliTest, VersionIsTheLibrarys) {
  const RunResult result = tet({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(result.out.substr(0, result.out.find(' ', 4)), "tet " TETFMT_VERSION);
}

TEST_F(CliTest, WrongCommandLinesAreUsageErrorsOfOneLine) {
  const std::vector<std::vector<std::string>> wrong = {
      {},
      {"frobnicate"},
      {"--frobnicate"},
      {"validate"},
      {"validate", "x.tet", "--level", "deep"},
      {"validate", "x.tet", "--format", "xml"},
      {"info"},
      {"info", "a.tet", "b.tet"},
      {"trace", "x.tet"},
      {"trace", "x.tet", "-o", "x.png", "--size", "10"},
      {"trace", "x.tet", "-o", "x.png", "--size", "0x10"},
      {"trace", "x.tet", "-o", "x.png", "--size", "99999x10"},
      {"trace", "x.tet", "-o", "x.png", "--size", "10x10x10"},
      {"trace", "x.tet", "-o", "x.png", "--eye", "1,2"},
      {"trace", "x.tet", "-o", "x.png", "--eye", "1,2,3,4"},
      {"trace", "x.tet", "-o", "x.png", "--eye", "1,two,3"},
      {"trace", "x.tet", "-o", "x.png", "--look-at", "nan,0,0"},
      {"trace", "x.tet", "-o", "x.png", "--up", "0,0,0"},
      {"trace", "x.tet", "-o", "x.png", "--fov", "180"},
      {"trace", "x.tet", "-o", "x.png", "--fov", "nan"},
      {"trace", "x.tet", "-o", "x.png", "--shade", "phong"},
      {"trace", "x.tet", "-o", "x.png", "--threads", "0"},
      {"trace", "x.tet", "-o", "x.png", "--threads", "many"},
      {"trace", "x.tet", "-o", "x.png", "--samples", "-1"},
      {"query", "x.tet"},
      {"query", "x.tet", "--rays", "r.csv"},
      {"query", "x.tet", "--rays", "r.txt", "--hits", "h.csv"},
      {"query", "x.tet", "--rays", "r.csv", "--hits", "h"},
      {"query", "x.tet", "--rays", "r.csv", "--hits", "h.csv", "--space", "outer"},
      {"query", "x.tet", "--rays", "r.csv", "--hits", "h.csv", "--kernel", "wrong"},
      {"query", "x.tet", "--rays", "r.csv", "--hits", "h.csv", "--answer", "last"},
      {"query", "x.tet", "--rays", "r.csv", "--hits", "h.csv", "--answer", "any", "--kernel", "float"},
      {"query", "x.tet", "--rays", "r.csv", "--hits", "h.csv", "--answer", "paths", "--kernel", "float"},
      {"sample", "cube", "-o", "x.obj"},
      {"sample", "sphere"},
      {"sample", "sphere", "-o", "x.xyz"},
      {"sample", "sphere", "-o", "x.obj", "--triangles", "7"},
      {"sample", "sphere", "-o", "x.obj", "--triangles", "-20"},
      {"sample", "sphere", "-o", "x.obj", "--triangles", "99999999999"},
      {"sample", "torus-knot", "-o", "x.obj", "--triangles", "499"},
      {"sample", "knots", "-o", "x.obj", "--triangles", "3999"},
      {"sample", "bumpy-plane", "-o", "x.obj", "--triangles", "1"},
  };
  for (const auto& arguments : wrong) {
    std::string line;
    for (const std::string& argument : arguments) line += " " + argument;
    const RunResult result = tet(arguments);
    EXPECT_EQ(result.exit_code, 1) << line << "\n" << result.err;
    EXPECT_EQ(result.out, "") << line;
    EXPECT_TRUE(is_one_line(
        result.err,
        arguments.empty() || arguments[0].find("frob") != std::string::npos ? "tet" : "tet " + arguments[0],
        {}))
        << line;
  }
  EXPECT_EQ(listing(), std::vector<std::string>{});
}

TEST_F(CliTest, UnreadableInputIsAnInputErrorForEveryReader) {
  std::filesystem::create_directory("folder");
  for (const std::string path : {"missing.tet", "folder", "missing/x.tet"}) {
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"validate", path},
                                                      {"info", path},
                                                      {"trace", path, "-o", "x.png"},
                                                      {"query", path, "--rays", "-", "--hits", "-"}}) {
      const RunResult result = tet(arguments);
      EXPECT_EQ(result.exit_code, 2) << arguments[0] << " " << path;
      EXPECT_EQ(result.out, "");
      EXPECT_TRUE(is_one_line(result.err, "tet " + arguments[0], {path}));
    }
  }
  EXPECT_EQ(listing(), std::vector<std::string>{"folder"});
}

TEST_F(CliTest, BrokenInputIsInvalidDataForEveryReader) {
  const std::string whole = read_bytes(write_mesh("whole.tet", box_mesh()));
  std::string newer = whole;
  newer[8] = 2;  // major version; the hash is then wrong too, but the version decides
  write_bytes("empty.tet", "");
  write_bytes("text.tet", "solid cube\nfacet normal 0 0 1\n" + std::string(400, ' '));
  write_bytes("cut.tet", std::string_view(whole).substr(0, whole.size() / 2));
  write_bytes("newer.tet", newer);
  write_bytes("line\nbreak.tet", "");
  for (const std::string path : {"empty.tet", "text.tet", "cut.tet", "newer.tet", "line\nbreak.tet"}) {
    const int code = path == "newer.tet" ? 5 : 3;
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"info", path},
                                                      {"trace", path, "-o", "x.png"},
                                                      {"query", path, "--rays", "-", "--hits", "x.csv"}}) {
      const RunResult result = tet(arguments, "0,0,0,1,0,0\n");
      EXPECT_EQ(result.exit_code, code) << arguments[0] << " " << path << ": " << result.err;
      EXPECT_EQ(result.out, "");
      EXPECT_TRUE(is_one_line(result.err, "tet " + arguments[0],
                              {path.starts_with("line") ? "line\\x0abreak" : path}));
    }
    const RunResult validated = tet({"validate", path});
    EXPECT_EQ(validated.exit_code, code) << path;
    EXPECT_NE(validated.out, "");
    EXPECT_TRUE(is_one_line(validated.err, "tet validate", {code == 5 ? "unsupported" : "invalid"}));
  }
  EXPECT_FALSE(std::filesystem::exists("x.png"));
  EXPECT_FALSE(std::filesystem::exists("x.csv"));
}

TEST_F(CliTest, UnwritableOutputLeavesNothingBehind) {
  write_mesh("box.tet", box_mesh());
  write_bytes("rays.csv", "13,23,10,0,0,1\n");
  std::filesystem::create_directory("folder.png");
  std::filesystem::create_directory("folder.csv");
  std::filesystem::create_directory("folder.obj");
  const auto before = listing();
  const std::vector<std::vector<std::string>> attempts = {
      {"trace", "box.tet", "--size", "16x16", "-o", "folder.png"},
      {"trace", "box.tet", "--size", "16x16", "-o", "missing/x.png"},
      {"trace", "box.tet", "--size", "16x16", "-o", "/dev/full"},
      {"trace", "box.tet", "--size", "16x16", "-o", "box.tet/x.png"},
      {"query", "box.tet", "--rays", "rays.csv", "--hits", "folder.csv"},
      {"query", "box.tet", "--rays", "rays.csv", "--hits", "missing/h.npy"},
      {"sample", "sphere", "-o", "folder.obj"},
      {"sample", "sphere", "-o", "missing/x.ply"},
  };
  for (const auto& arguments : attempts) {
    const RunResult result = tet(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments.back() << ": " << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(is_one_line(result.err, "tet " + arguments[0], {arguments.back(), "cannot"}));
    EXPECT_EQ(listing(), before) << arguments.back();
  }
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));  // it was written to, not replaced
}

TEST_F(CliTest, FullDiskUnderStandardOutputIsAnError) {
  write_mesh("box.tet", box_mesh());
  for (const std::string verb : {"info box.tet", "validate --format json box.tet", "--help"}) {
    const RunResult result = shell("\"$TET\" " + verb + " > /dev/full");
    EXPECT_EQ(result.exit_code, 2) << verb;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find("standard output"), std::string::npos) << result.err;
  }
}

TEST_F(CliTest, FullDiskUnderALinkedTargetIsAnError) {
  write_mesh("box.tet", box_mesh());
  write_bytes("rays.csv", "13,23,10,0,0,1\n");
  std::filesystem::create_symlink("/dev/full", "full.npy");
  std::filesystem::create_symlink("/dev/full", "full.obj");
  const RunResult query = tet({"query", "box.tet", "--rays", "rays.csv", "--hits", "full.npy"});
  EXPECT_EQ(query.exit_code, 2);
  EXPECT_TRUE(is_one_line(query.err, "tet query", {"full.npy", "No space left"}));
  const RunResult sample = tet({"sample", "sphere", "-o", "full.obj"});
  EXPECT_EQ(sample.exit_code, 2);
  EXPECT_TRUE(is_one_line(sample.err, "tet sample", {"full.obj", "No space left"}));
  EXPECT_TRUE(std::filesystem::is_symlink("full.npy"));
}

TEST_F(CliTest, ReaderThatGoesAwayEndsQuietly) {
  write_mesh("box.tet", box_mesh());
  // Far more than a pipe holds, and nobody reads it.
  const RunResult result = shell(
      "awk 'BEGIN { for (i = 0; i < 20000; ++i) print \"13,23,10,0,0,1\" }' > rays.csv\n"
      "{ \"$TET\" query box.tet --rays rays.csv --hits -; echo \"exit $?\" >&2; } | true");
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err, "exit 141\n");  // SIGPIPE, as of any other filter
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(CliTest, RunningOutOfMemoryIsOneLine) {
  write_mesh("box.tet", box_mesh());
  const RunResult result =
      shell("ulimit -v 1000000; exec \"$TET\" trace box.tet -o x.png --size 16384x16384 --threads 1");
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_TRUE(is_one_line(result.err, "tet trace", {"out of memory"}));
  EXPECT_EQ(listing(), std::vector<std::string>{"box.tet"});
}
#endif

#ifndef TET_HAS_CONVERTER
TEST_F(CliTest, BuildWithoutConverterSaysSo) {
  const RunResult result = tet({"convert", "x.obj", "-o", "x.tet", "--layout", "tet16"});
  EXPECT_EQ(result.exit_code, 5);
  EXPECT_TRUE(is_one_line(result.err, "tet convert", {"this build has no converter"}));
}
#endif

TEST_F(CliTest, WrongWordsAreToldPlainly) {
  const RunResult verb = tet({"foo", "a.tet"});
  EXPECT_EQ(verb.exit_code, 1);
  EXPECT_TRUE(is_one_line(verb.err, "tet", {"unknown verb 'foo'"}));
  const RunResult choice = tet({"query", "a.tet", "--rays", "-", "--hits", "-", "--kernel", "fast"});
  EXPECT_EQ(choice.exit_code, 1);
  EXPECT_TRUE(is_one_line(choice.err, "tet query", {"--kernel", "must be exact or float, not fast"}));
  const RunResult more = tet({"trace", "a.tet", "-o", "a.png", "--shade", "red"});
  EXPECT_TRUE(
      is_one_line(more.err, "tet trace", {"must be scene, lambert, normal, depth or steps, not red"}));
}

TEST_F(CliTest, UnreadableFilesAreNamedOnce) {
  std::filesystem::create_directory("folder.tet");
  for (const std::string name : {"missing.tet", "folder.tet"}) {
    for (const std::vector<std::string>& line : {std::vector<std::string>{"info", name},
                                                 {"validate", name},
                                                 {"query", name, "--rays", "r.csv", "--hits", "-"}}) {
      const RunResult result = tet(line);
      EXPECT_EQ(result.exit_code, 2);
      const auto first = result.err.find(name);
      ASSERT_NE(first, std::string::npos);
      EXPECT_EQ(result.err.find(name, first + 1), std::string::npos) << result.err;
    }
  }
}

}  // namespace
}  // namespace tetfmt_test
