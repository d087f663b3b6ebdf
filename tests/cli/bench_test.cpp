// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet bench`: what it says of a sound file, in every form, and of a wrong command line.
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "cli/cli_support.hpp"

namespace tetfmt_test {
namespace {

using Json = nlohmann::json;

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

  std::istringstream csv(read_bytes("out.csv"));
  std::string line;
  std::vector<std::string> lines;
  while (std::getline(csv, line)) lines.push_back(line);
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

TEST_F(CliTest, BenchTimesAFileAndItsOtherLayout) {
  const std::string file = write_mesh("box.tet", box_mesh());
  const std::string other = write_mesh("box16.tet", box_mesh(), tetfmt::Layout::tet16);
  const RunResult result = tet({"bench", file, "--other", other, "--size", "16", "--repeats", "1"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const char* part : {"map and open", "distance 16.50", "Tet20 exact", "Tet16 float"})
    EXPECT_NE(result.out.find(part), std::string::npos) << part;
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
  refused({"--stress", file, "--other", file}, 1, {"--other"});
  refused({file, file}, 1, {"one FILE"});
  refused({file, "--json", "a.json"}, 1, {"--stress"});
  refused({"--stress", file, "--csv", file}, 1, {file});
  refused({"--stress", file, "--csv", "a.csv", "--json", "a.csv"}, 1, {"a.csv"});
  refused({"--stress", file, "--csv", "-"}, 1, {"/dev/stdout"});
  refused({"--stress", file, "--size", "9"}, 1, {"--size", "--stress"});
  refused({file, "--rays", "9"}, 1, {"--rays", "--stress"});
  refused({file, "--fov", "nan"}, 1, {"--fov", "nan"});
  refused({file, "--other", file, "--size", "4"}, 7, {"other layout"});
  refused({"--stress", "none.tet"}, 2, {"none.tet"});
  write_bytes("text.tet", "no tet file");
  refused({"--stress", "text.tet", "--json", "a.json"}, 3, {"text.tet"});
  EXPECT_EQ(listing(), (std::vector<std::string>{"box.tet", "text.tet"})) << "nothing is left behind";
}

}  // namespace
}  // namespace tetfmt_test
