// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet bench`: what it says of a sound file, in every form, and of a wrong command line.
#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "cli/cli_support.hpp"

namespace tetfmt_test {
namespace {

using Json = nlohmann::json;

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST_F(CliTest, BenchStressFindsNoFailureAndTellsWhatItDid) {
  const std::string file = write_mesh("box.tet", box_mesh());
  const std::string other = write_mesh("box16.tet", box_mesh(), tetfmt::Layout::tet16);
  const RunResult result = tet({"bench", "--stress", file, other, "--rays", "20000", "--sets",
                                "outside,vertices,intervals,parity,bounces", "--seed", "7", "--csv",
                                "out.csv", "--json", "out.json"});
  EXPECT_EQ(result.exit_code, 0) << result.out;
  for (const char* part : {"seed 7", "box.tet", "box16.tet", "closed", "outside", "bounces", "version",
                           "compiler", "processor", "no failures"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part;

  const Json json = Json::parse(read_bytes("out.json"));
  EXPECT_EQ(json.at("rows").size(), 10U);
  EXPECT_EQ(json.at("failures"), 0);
  EXPECT_TRUE(json.at("reproducers").empty());
  EXPECT_EQ(json.at("meshes").size(), 2U);
  EXPECT_EQ(json.at("seed"), 7);
  std::uint64_t rays = 0;
  for (const Json& row : json.at("rows")) {
    rays += row.at("rays").get<std::uint64_t>();
    EXPECT_GT(row.at("hits"), 0) << row.at("set");
    EXPECT_LE(row.at("t_error_ulp").at("above_1_degree").at("max"), 4);
  }
  EXPECT_EQ(json.at("total").at("rays"), rays);
  EXPECT_GE(rays, 19990U);

  const std::vector<std::string> lines = lines_of(read_bytes("out.csv"));
  ASSERT_EQ(lines.size(), 11U);
  EXPECT_TRUE(lines[0].starts_with("file,set,rays,hits,wrong,missed,false,double,hung,started,self,differ,"));
  const auto fields = [](const std::string& text) { return std::count(text.begin(), text.end(), ','); };
  for (const std::string& row : lines) EXPECT_EQ(fields(row), fields(lines[0])) << row;
  EXPECT_TRUE(lines[1].starts_with("\"box.tet\",outside,")) << lines[1];
}

TEST_F(CliTest, BenchStressFindsTheSameWithAnyNumberOfThreads) {
  const std::string file = write_mesh("box.tet", box_mesh());
  const auto counts = [&](const std::string& threads) {
    const std::string name = threads + ".json";
    EXPECT_EQ(tet({"bench", "--stress", file, "--rays", "30000", "--threads", threads, "--json", name,
                   "--sets", "inside,from-vertices"})
                  .exit_code,
              0);
    Json rows = Json::parse(read_bytes(name)).at("rows");
    for (Json& row : rows) row.erase("thread_seconds");
    return rows;
  };
  EXPECT_EQ(counts("1"), counts("3"));
}

TEST_F(CliTest, BenchQuickMeasuresEveryTracerOnEveryWorkload) {
  const std::string file = write_mesh("box.tet", box_mesh());
  const RunResult result = tet({"bench", file, "--quick", "--size", "24", "--sample", "200", "--csv",
                                "out.csv", "--json", "out.json", "--pictures", "pictures"});
  EXPECT_EQ(result.exit_code, 0) << result.out;
  for (const char* part : {"version", "commit", "compiler", "processor", "seed 1", "box.tet", "open ",
                           "validate ", "Tet20", "Tet16", "SAH BVH", "SAH k-d tree", "camera-16.5",
                           "tet20-exact", "kd-tree", "answers of exact tracers that are wrong: 0"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part;

  const Json json = Json::parse(read_bytes("out.json"));
  for (const char* key : {"version", "commit", "compiler", "processor", "against"})
    EXPECT_FALSE(json.at(key).get<std::string>().empty()) << key;
  EXPECT_TRUE(json.at("flags").is_string());
  EXPECT_EQ(json.at("seed"), 1);
  EXPECT_EQ(json.at("failures"), 0);
  ASSERT_EQ(json.at("meshes").size(), 1U);
  const Json& mesh = json.at("meshes")[0];
  EXPECT_EQ(mesh.at("triangles"), 12);
  std::map<std::string, double> bytes;
  for (const Json& structure : mesh.at("structures"))
    bytes[structure.at("name")] = structure.at("bytes").get<double>();
  EXPECT_EQ(bytes.at("Tet20") - bytes.at("Tet16"), 4 * mesh.at("tets").get<double>());
  EXPECT_GT(bytes.at("SAH BVH"), 12 * 40);
  EXPECT_GT(bytes.at("SAH k-d tree"), 12 * 40);

  // Every tracer in every workload that it takes.
  std::map<std::string, std::set<std::string>> tracers;
  for (const Json& workload : mesh.at("workloads")) {
    EXPECT_GT(workload.at("rays"), 0);
    EXPECT_EQ(workload.at("sample_wrong"), 0);
    for (const Json& row : workload.at("rows")) {
      tracers[workload.at("name")].insert(row.at("tracer"));
      EXPECT_EQ(row.at("ns").at("all").size(), 3U);
      EXPECT_GT(row.at("ns").at("median"), 0);
      EXPECT_LE(row.at("ns").at("low"), row.at("ns").at("high"));
      const Json& ratio = row.at("ratios").at(json.at("against").get<std::string>());
      EXPECT_LE(ratio.at("low"), ratio.at("median"));
      EXPECT_LE(ratio.at("median"), ratio.at("high"));
      // A ray that misses the box altogether visits no node of the k-d tree.
      if (row.at("tracer") == "bvh" || (row.at("tracer") == "kd-tree" && workload.contains("distance"))) {
        EXPECT_GT(row.at("visits"), 0);
      }
      if (row.at("exact")) {
        EXPECT_EQ(row.at("wrong").get<int>() + row.at("missed").get<int>(), 0);
      }
    }
  }
  EXPECT_EQ(tracers.size(), 15U);
  for (const auto& [workload, names] : tracers)
    for (const char* name : {"tet20-exact", "tet16-exact", "bvh", "kd-tree"})
      EXPECT_TRUE(names.contains(name)) << workload << ": " << name;
  for (const char* name : {"tet20-float", "tet20-together", "tet16-together", "tet20-float-first",
                           "tet20-exact-specialised", "tet20-float-orthonormal"})
    EXPECT_TRUE(tracers.at("room").contains(name)) << name;

  const auto csv = lines_of(read_bytes("out.csv"));
  std::size_t rows = 0;
  for (const auto& [workload, names] : tracers) rows += names.size();
  ASSERT_EQ(csv.size(), rows + 1);
  EXPECT_TRUE(csv[0].starts_with("file,triangles,tets,workload,distance,tracer,exact,rays,ns,"));
  for (const std::string& row : csv)
    EXPECT_EQ(std::count(row.begin(), row.end(), ','), std::count(csv[0].begin(), csv[0].end(), ',')) << row;
  EXPECT_TRUE(csv[1].starts_with("\"box.tet\",12,")) << csv[1];

  for (const char* name : {"box-errors.svg", "box-table1.svg"}) {
    const std::string svg = read_bytes(std::string("pictures/") + name);
    EXPECT_TRUE(svg.starts_with("<svg xmlns=")) << name;
    EXPECT_TRUE(svg.ends_with("</svg>\n")) << name;
    EXPECT_NE(svg.find("kd-tree"), std::string::npos) << name;
  }
}

TEST_F(CliTest, BenchComparesMeshesOfSeveralSizesAndPartsByName) {
  LatticeOptions options;
  options.low = 2;
  options.one_triangle_a_face = true;
  const std::string small = write_mesh("small.tet", lattice_mesh(6, options)),
                    large = write_mesh("large.tet", lattice_mesh(12, options), tetfmt::Layout::tet16);
  const RunResult result =
      tet({"bench", small, large, "--tracers", "tet20-exact,bvh", "--workloads", "camera-9,ao", "--size",
           "20", "--repeats", "2", "--shuffled", "--against", "bvh", "--pictures", ".", "--csv", "out.csv"});
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  for (const char* part :
       {"/ bvh", "| tracer ", "|----", "small.tet: nanoseconds a ray", "large.tet: wrong + missed",
        "ao-10: nanoseconds a ray, by mesh", "| 48 triangles", "| 768 triangles"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
  std::set<std::string> seen;
  for (const std::string& line : lines_of(read_bytes("out.csv"))) {
    std::istringstream fields(line);
    std::string file, triangles, tets, workload, distance, tracer;
    for (std::string* field : {&file, &triangles, &tets, &workload, &distance, &tracer})
      std::getline(fields, *field, ',');
    seen.insert(file + " " + workload + " " + tracer);
  }
  // Two files, two tracers, four workloads in two orders each; and the head.
  EXPECT_EQ(seen.size(), 2U * 2U * 4U * 2U + 1U);
  EXPECT_TRUE(seen.contains("\"large.tet\" ao-2-shuffled bvh"));
  EXPECT_EQ(listing(), (std::vector<std::string>{"growth.svg", "large-errors.svg", "large.tet", "out.csv",
                                                 "small-errors.svg", "small.tet"}));
  EXPECT_NE(read_bytes("growth.svg").find("camera-9-shuffled"), std::string::npos);
}

TEST_F(CliTest, BenchWritesItsTableBeforePictures) {
  const std::string file = write_mesh("box.tet", box_mesh());
  std::filesystem::create_directories("pictures/box-errors.svg");  // in the way of the picture
  const RunResult result = tet({"bench", file, "--tracers", "bvh", "--workloads", "lines", "--size", "8",
                                "--repeats", "1", "--pictures", "pictures"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("box-errors.svg"), std::string::npos) << result.err;
  EXPECT_NE(result.out.find("box.tet: nanoseconds a ray"), std::string::npos) << result.out;
}

TEST_F(CliTest, BenchLeavesOutTablesOfNothing) {
  const std::string file = write_mesh("box.tet", box_mesh());
  const RunResult result =
      tet({"bench", file, "--tracers", "tet20-float,tet20-float-orthonormal", "--workloads", "lines,shadow",
           "--size", "8", "--repeats", "1", "--against", "tet20-float", "--json", "out.json"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const Json workloads = Json::parse(read_bytes("out.json")).at("meshes")[0].at("workloads");
  ASSERT_EQ(workloads.size(), 1U) << "no float tracer answers shadow rays";
  EXPECT_EQ(workloads[0].at("name"), "lines");
  EXPECT_EQ(workloads[0].at("rows").size(), 2U);
  EXPECT_EQ(result.out.find("shadow"), std::string::npos) << result.out;

  const RunResult absent = tet({"bench", file, "--tracers", "tet20-exact,tet20-float", "--workloads",
                                "shadow", "--size", "8", "--repeats", "1", "--against", "tet20-float"});
  EXPECT_EQ(absent.exit_code, 0) << absent.err;
  EXPECT_NE(absent.out.find("box.tet: nanoseconds a ray"), std::string::npos) << absent.out;
  EXPECT_EQ(absent.out.find("time / tet20-float"), std::string::npos) << absent.out;
}

TEST_F(CliTest, BenchLooksAtEveryInputBeforeLongWork) {
  const std::string file = write_mesh("box.tet", box_mesh());
  write_bytes("text.tet", "no tet file");
  // Neither of these could be run to its end within the time of a test.
  EXPECT_EQ(tet({"bench", file, "text.tet", "--size", "10000", "--repeats", "1000"}).exit_code, 3);
  EXPECT_EQ(tet({"bench", "--stress", file, "text.tet", "--rays", "1000000000000"}).exit_code, 3);
#ifdef TET_HAS_CONVERTER
  EXPECT_EQ(tet({"sample", "sphere", "-o", "ball.off", "--triangles", "3000"}).exit_code, 0);
  const auto refused = [&](const std::string& mesh, int code, const std::string& named) {
    const RunResult result = tet({"bench", "--convert", "ball.off", mesh, "--repeats", "1000"});
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_NE(result.err.find(named + ": "), std::string::npos) << result.err;
  };
  refused("none.off", 2, "none.off");
  write_bytes("ball.xyz", "0 0 0");
  refused("ball.xyz", 5, "ball.xyz");
  setenv("TMPDIR", "/none", 1);
  refused("ball.off", 2, "/none");
  unsetenv("TMPDIR");
#endif
}

TEST_F(CliTest, BenchConvertTimesEveryStage) {
  EXPECT_EQ(tet({"sample", "sphere", "-o", "ball.off", "--triangles", "300"}).exit_code, 0);
  const RunResult result =
      tet({"bench", "--convert", "ball.off", "--repeats", "2", "--csv", "out.csv", "--json", "out.json"});
#ifdef TET_HAS_CONVERTER
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const char* part : {"ball.off, --optimize fast", "tetrahedralize", "tetgen: delaunay",
                           "reduce crossings", "of that TetGen", "processor"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
  const Json json = Json::parse(read_bytes("out.json"));
  ASSERT_EQ(json.at("conversions").size(), 3U);
  for (const Json& conversion : json.at("conversions")) {
    EXPECT_EQ(conversion.at("triangles"), 300);
    EXPECT_GT(conversion.at("tets"), 0);
    const bool none = conversion.at("optimize") == "none";
    EXPECT_EQ(conversion.at("reduce_crossings_seconds").at("median") == 0, none);
    // Stages are parts of the whole; TetGen's are parts of one of them.
    double sum = 0;
    for (const Json& stage : conversion.at("stages"))
      if (!stage.at("name").get<std::string>().starts_with("tetgen: "))
        sum += stage.at("seconds").at("low").get<double>();
    EXPECT_GT(sum, 0);
    EXPECT_LE(sum, conversion.at("seconds").at("high").get<double>());
    EXPECT_LE(conversion.at("tetgen_seconds").at("low"), conversion.at("seconds").at("high"));
  }
  const auto csv = lines_of(read_bytes("out.csv"));
  EXPECT_EQ(csv[0], "file,triangles,tets,optimize,stage,seconds,seconds_low,seconds_high");
  EXPECT_GT(csv.size(), 30U);
  for (const std::string& row : csv) EXPECT_EQ(std::count(row.begin(), row.end(), ','), 7) << row;
  EXPECT_EQ(listing(), (std::vector<std::string>{"ball.off", "out.csv", "out.json"}));
#else
  EXPECT_EQ(result.exit_code, 5);
  EXPECT_TRUE(is_one_line(result.err, "tet bench", {"--convert", "converter"}));
#endif
}

TEST_F(CliTest, BenchRefusesWhatItCannotDo) {
  const std::string file = write_mesh("box.tet", box_mesh());
  const auto refused = [&](const std::vector<std::string>& arguments, int code,
                           const std::vector<std::string>& parts) {
    std::vector<std::string> all = {"bench"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const RunResult result = tet(all);
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_EQ(result.out, "");
    // Progress may come before the message, which is the last line.
    const std::string last = result.err.substr(result.err.rfind("tet bench:"));
    EXPECT_TRUE(is_one_line(last, "tet bench", parts));
  };
  refused({"--stress", file, "--sets", "vertices,needles"}, 1, {"needles", "from-vertices"});
  refused({"--stress", file, "--rays", "0"}, 1, {"--rays"});
  refused({"--stress", file, "--seed", "-1"}, 1, {"--seed", "-1"});
  refused({file, "--tracers", "tet20-exact,tet24"}, 1, {"tet24", "tet20-exact", "kd-tree"});
  refused({file, "--workloads", "cam"}, 1, {"'cam'", "camera-16.5", "ao-10", "lines"});
  refused({file, "--tracers", "bvh", "--against", "kd-tree"}, 1, {"--against", "kd-tree"});
  refused({file, "--csv", file}, 1, {file});
  refused({file, "--pictures", file}, 2, {file, "--pictures"});
  refused({file, "--pictures", "/proc"}, 2, {"/proc", "create a file"});
  refused({file, "--tracers", "tet20-float", "--workloads", "shadow", "--size", "8"}, 1,
          {"--tracers", "--workloads"});
  refused({"--stress", file, "--quick"}, 1, {"--quick", "--stress"});
  refused({"--convert", file, "--tracers", "bvh"}, 1, {"--tracers", "--convert"});
  refused({"--stress", file, "--convert"}, 1, {"--stress", "--convert"});
  refused({"--stress", file, "--csv", file}, 1, {file});
  refused({"--stress", file, "--csv", "a.csv", "--json", "a.csv"}, 1, {"--csv and --json", "a.csv"});
  refused({file, "--csv", "a", "--json", "./a"}, 1, {"--csv and --json", "./a"});
  refused({"--stress", file, "--csv", "-"}, 1, {"/dev/stdout"});
  refused({"--stress", file, "--size", "9"}, 1, {"--size", "--stress"});
  refused({file, "--rays", "9"}, 1, {"--rays", "--stress"});
  refused({file, "--fov", "nan"}, 1, {"--fov", "nan"});
  refused({"--stress", "none.tet"}, 2, {"none.tet"});
  write_bytes("text.tet", "no tet file");
  refused({"--stress", "text.tet", "--json", "a.json"}, 3, {"text.tet"});
  EXPECT_EQ(listing(), (std::vector<std::string>{"box.tet", "text.tet"})) << "nothing is left behind";
}

}  // namespace
}  // namespace tetfmt_test
