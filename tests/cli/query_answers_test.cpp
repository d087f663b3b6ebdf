// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet query --answer any|all|paths`, and rays with t_min and t_max: against the inner box, whose every
// crossing and length is a round number.
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <sstream>

#include "cli/cli_support.hpp"
#include "cli/npy_bytes.hpp"
#include "support/region_mesh.hpp"

namespace tetfmt_test {
namespace {

using Row8 = std::array<double, 8>;
using Line = std::vector<std::string>;

/// The lines of CSV output behind its header, which must be this.
std::vector<Line> table(const std::string& text, const std::string& header) {
  std::istringstream lines(text);
  std::string line;
  EXPECT_TRUE(std::getline(lines, line));
  EXPECT_EQ(line, header);
  std::vector<Line> rows;
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    Line row;
    for (std::string field; std::getline(fields, field, ',');) row.push_back(field);
    rows.push_back(row);
  }
  return rows;
}

double to_double(const std::string& text) {
  return std::strtod(text.c_str(), nullptr);
}

constexpr const char* kFirst = "triangle,t,u,v,side,tet,neighbor";
constexpr const char* kAll = "ray,hit,triangle,t,u,v,side,tet,neighbor,region,beyond,length";
constexpr const char* kPaths = "ray,region,length";

/// The inner box is [12, 14] x [22, 24] x [32, 34] in model coordinates, the hull [10, 16] x ...; region 1 is
/// inside of the box.
class QueryAnswers : public CliTest {
 protected:
  void SetUp() override {
    CliTest::SetUp();
    write_mesh("box.tet", with_regions(box_mesh(), {0, 1}));
  }
  RunResult ask(const std::string& answer, const std::string& rays, const std::string& file = "box.tet") {
    return tet({"query", file, "--rays", "-", "--hits", "-", "--answer", answer}, rays);
  }
  std::vector<Line> rows(const std::string& answer, const std::string& rays, const char* header,
                         const std::string& file = "box.tet") {
    const RunResult result = ask(answer, rays, file);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return table(result.out, header);
  }
};

// Through the box along z at t = 1 and t = 2: direction (0, 0, 2) from z = 30.
TEST_F(QueryAnswers, OnlyWhatLiesInTheIntervalCounts) {
  const std::string ray = "13.3,23.1,30,0,0,2,";
  const auto t_of = [&](const std::string& interval) {
    const auto found = rows("first", ray + interval + "\n", kFirst);
    EXPECT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].size(), 7u);
    return to_double(found[0][1]);
  };
  EXPECT_EQ(t_of("0,inf"), 1);
  EXPECT_EQ(t_of("-3,1e300"), 1);
  EXPECT_EQ(t_of("0.5,1.5"), 1);
  EXPECT_EQ(t_of("1.0000000001,inf"), 2);
  EXPECT_EQ(t_of("1.5,2.5"), 2);
  EXPECT_EQ(t_of("0,0.9999999999"), INFINITY);
  EXPECT_EQ(t_of("1.25,1.75"), INFINITY);
  EXPECT_EQ(t_of("2.5,inf"), INFINITY);
  // Exactly at an end: in one of the two, not in both.
  EXPECT_NE(std::isinf(t_of("0,1")), t_of("1,inf") == 2);
  // A header line may name the columns.
  const auto named = rows("first", "ox,oy,oz,dx,dy,dz,t_min,t_max\n" + ray + "1.5,inf\n", kFirst);
  ASSERT_EQ(named.size(), 1u);
  EXPECT_EQ(named[0][1], "2");
}

std::vector<Row8> random_rays(std::size_t count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(0, 6), direction(-1, 1), end(0, 12);
  std::vector<Row8> rays(count);
  for (Row8& ray : rays) {
    for (std::size_t i = 0; i < 3; ++i) ray[i] = static_cast<double>(place(random));
    for (std::size_t i = 3; i < 6; ++i) ray[i] = static_cast<double>(direction(random));
    ray[6] = static_cast<double>(end(random)) / 2;
    ray[7] = ray[6] + static_cast<double>(end(random));
    ray[7] = static_cast<double>(static_cast<float>(ray[7]));
  }
  for (std::size_t i = 0; i < count; i += 3) {
    rays[i][6] = 0;
    rays[i][7] = INFINITY;
  }
  return rays;
}

TEST_F(QueryAnswers, FormatsWithIntervalsAgree) {
  const auto rays = random_rays(3000);
  write_bytes("f4.npy", npy_bytes<float>(rays));
  write_bytes("f8.npy", npy_bytes<double>(rays));
  write_bytes("fortran.npy", npy_bytes<double>(rays, {.fortran = true}));
  std::ostringstream csv;
  csv.precision(17);
  for (const Row8& r : rays) {
    for (std::size_t i = 0; i < 8; ++i) csv << (i == 0 ? "" : ",") << r[i];
    csv << '\n';
  }
  write_bytes("rays.csv", csv.str());
  for (const std::string answer : {"first", "any", "all", "paths"}) {
    std::string expected;
    for (const std::string name : {"f4.npy", "f8.npy", "fortran.npy", "rays.csv"}) {
      for (const std::string threads : {"1", "3"}) {
        const RunResult result = tet({"query", "box.tet", "--rays", name, "--hits", "-", "--answer", answer,
                                      "--space", "local", "--threads", threads});
        ASSERT_EQ(result.exit_code, 0) << result.err;
        ASSERT_EQ(result.err, "");
        if (expected.empty()) expected = result.out;
        EXPECT_EQ(result.out, expected) << answer << ' ' << name << ' ' << threads;
      }
    }
    EXPECT_GT(std::count(expected.begin(), expected.end(), '\n'), 300) << answer;
  }
}

// The four answers to the same rays tell one story.
TEST_F(QueryAnswers, AnswersAgreeWithEachOther) {
  const auto rays = random_rays(3000);
  write_bytes("rays.npy", npy_bytes<double>(rays));
  const auto answers = [&](const std::string& answer, const char* header) {
    const RunResult result = tet(
        {"query", "box.tet", "--rays", "rays.npy", "--hits", "-", "--answer", answer, "--space", "local"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return table(result.out, header);
  };
  const auto first = answers("first", kFirst), any = answers("any", "blocked"), all = answers("all", kAll),
             paths = answers("paths", kPaths);
  ASSERT_EQ(first.size(), rays.size());
  ASSERT_EQ(any.size(), rays.size());
  std::size_t blocked = 0, row = 0, path = 0, both_regions = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto& [ox, oy, oz, dx, dy, dz, t_min, t_max] = rays[i];
    const double unit = std::sqrt(dx * dx + dy * dy + dz * dz);
    ASSERT_EQ(any[i], Line{first[i][0] == "-1" ? "0" : "1"});
    blocked += any[i][0] == "1";
    double in_box = 0;
    std::size_t hit = 0;
    for (; row < all.size() && all[row][0] == std::to_string(i); ++row, ++hit) {
      const Line& line = all[row];
      ASSERT_EQ(line.size(), 12u);
      ASSERT_EQ(line[1], std::to_string(hit));
      if (hit == 0) {
        ASSERT_EQ(Line(line.begin() + 2, line.begin() + 9), first[i]);
      }
      const double t = to_double(line[3]);
      ASSERT_GE(t, t_min);
      ASSERT_LE(t, t_max);
      // In front of the box is region 0, behind its walls 1.
      ASSERT_EQ(line[9], line[6]);
      ASSERT_NE(line[10], line[9]);
      if (hit == 0 && line[9] == "1") in_box += (t - t_min) * unit;
      if (line[10] == "1") in_box += to_double(line[11]);
      const bool last = row + 1 == all.size() || all[row + 1][0] != line[0];
      const double end = last ? t_max : to_double(all[row + 1][3]);
      if (std::isinf(end)) {
        ASSERT_EQ(line[11], "inf");
      } else {
        ASSERT_NEAR(to_double(line[11]), (end - t) * unit, 1e-12);
      }
    }
    ASSERT_EQ(hit > 0, any[i][0] == "1");
    // The paths: region 0 before region 1, and together as long as the interval.
    std::map<std::string, double> length;
    for (; path < paths.size() && paths[path][0] == std::to_string(i); ++path) {
      ASSERT_EQ(paths[path].size(), 3u);
      ASSERT_TRUE(length.empty() || paths[path][1] == "1");
      length[paths[path][1]] = to_double(paths[path][2]);
    }
    if (hit > 0) {
      ASSERT_NEAR(length.contains("1") ? length["1"] : 0, in_box, 1e-12);
    }
    both_regions += length.size() == 2;
    double sum = 0;
    for (const auto& [region, value] : length) sum += value;
    if (std::isinf(t_max)) {
      ASSERT_EQ(sum, INFINITY);
    } else {
      ASSERT_NEAR(sum, (t_max - t_min) * unit, 1e-12);
    }
  }
  EXPECT_EQ(row, all.size());
  EXPECT_EQ(path, paths.size());
  EXPECT_GT(blocked, 100u);
  EXPECT_GT(both_regions, 100u);
}

TEST_F(QueryAnswers, LengthsAreInModelUnits) {
  // Along x through the box at x = 12 and 14; direction of length 4.
  const std::string ray = "8,23.3,33.1,4,0,0";
  const auto all = rows("all", ray + "\n", kAll);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0][3], "1");
  EXPECT_EQ(all[0][6], "0");
  EXPECT_EQ(all[0][9] + all[0][10], "01");
  EXPECT_EQ(all[0][11], "2");
  EXPECT_EQ(all[1][3], "1.5");
  EXPECT_EQ(all[1][6], "1");
  EXPECT_EQ(all[1][9] + all[1][10], "10");
  EXPECT_EQ(all[1][11], "inf");
  EXPECT_EQ(rows("all", ray + ",0,2\n", kAll)[1][11], "2");
  EXPECT_TRUE(rows("all", "8,20.3,33.1,4,0,0\n", kAll).empty());  // misses have no rows

  EXPECT_EQ(rows("paths", ray + "\n", kPaths), (std::vector<Line>{{"0", "0", "inf"}, {"0", "1", "2"}}));
  EXPECT_EQ(rows("paths", ray + ",0,1.25\n", kPaths), (std::vector<Line>{{"0", "0", "4"}, {"0", "1", "1"}}));
  EXPECT_EQ(rows("paths", ray + ",1.125,1.375\n", kPaths), (std::vector<Line>{{"0", "1", "1"}}));
  EXPECT_EQ(rows("paths", ray + ",2,3\n", kPaths), (std::vector<Line>{{"0", "0", "4"}}));
  // From inside, from beyond the hull away from it, and nothing at all.
  EXPECT_EQ(rows("paths", "13,23.3,33.125,0,0,-0.5,0,4\n", kPaths),
            (std::vector<Line>{{"0", "0", "0.875"}, {"0", "1", "1.125"}}));
  EXPECT_EQ(rows("paths", "0,0,0,-1,0,0,0,5\n", kPaths), (std::vector<Line>{{"0", "0", "5"}}));
  EXPECT_TRUE(rows("paths", "0,0,0,-1,0,0,5,5\n", kPaths).empty());
}

TEST_F(QueryAnswers, OpenSurfacesMakeNoRegions) {
  LatticeOptions options;
  options.low = 2;
  options.walls = 0b000011;  // x = 2 and x = 4
  write_mesh("open.tet", with_regions(lattice_mesh(6, options), {0}));
  const std::string ray = "-1,3.3,2.9,1,0,0,0,10\n";
  const auto all = rows("all", ray, kAll, "open.tet");
  ASSERT_EQ(all.size(), 2u);
  for (const Line& line : all) EXPECT_EQ(line[9] + line[10], "00");
  EXPECT_EQ(rows("paths", ray, kPaths, "open.tet"), (std::vector<Line>{{"0", "0", "10"}}));
}

TEST_F(QueryAnswers, LeftOutSpaceIsToldAndNotMeasured) {
  write_mesh("outside.tet", with_regions(box_mesh(), {0}));
  // Into the box, past it, and from its inside.
  const std::string rays = "13.3,23.1,50,0,0,-1,0,30\n0,0,0,-1,0,0,0,5\n13,23,33,0,0,1,0,9\n";
  const auto warned = [&](const RunResult& result) {
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_TRUE(is_one_line(result.err, "tet query", {"1 ray", "leaves out", "first ray 2", "--keep all"}));
  };
  const RunResult any = ask("any", rays, "outside.tet"), all = ask("all", rays, "outside.tet"),
                  paths = ask("paths", rays, "outside.tet");
  warned(any), warned(all), warned(paths);
  EXPECT_EQ(any.out, "blocked\n1\n0\n-2\n");
  const auto crossings = table(all.out, kAll);
  ASSERT_EQ(crossings.size(), 1u);
  EXPECT_EQ(crossings[0][3], "16");
  EXPECT_EQ(crossings[0][9], "0");
  EXPECT_EQ(crossings[0][10], "-1");
  EXPECT_EQ(crossings[0][11], "nan");
  EXPECT_EQ(table(paths.out, kPaths),
            (std::vector<Line>{{"0", "-1", "nan"}, {"0", "0", "16"}, {"1", "0", "5"}, {"2", "-1", "nan"}}));
}

TEST_F(QueryAnswers, FilesWithoutRegionsSaySo) {
  write_mesh("untold.tet", box_mesh());
  const auto all = rows("all", "8,23.3,33.1,4,0,0\n", kAll, "untold.tet");
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0][9] + all[0][10] + all[0][11], "-1-12");
  const RunResult paths = ask("paths", "8,23.3,33.1,4,0,0\n", "untold.tet");
  EXPECT_EQ(paths.exit_code, 3);
  EXPECT_EQ(paths.out, "");
  EXPECT_TRUE(is_one_line(paths.err, "tet query", {"untold.tet", "REGN", "paths", "tet convert"}));
}

TEST_F(QueryAnswers, EmptyIntervalsAreTold) {
  const RunResult result = ask("any", "13,23,33,1,0,0,0,5\n13,23,33,1,0,0,5,0\n13,23,33,1,0,0,-2,-1\n");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, "blocked\n1\n0\n0\n");
  EXPECT_TRUE(
      is_one_line(result.err, "tet query",
                  {"2 rays of standard input have t_max below t_min or 0", "hit nothing, first ray 1"}));
  EXPECT_EQ(rows("paths", "13,23,33,1,0,0,0,0\n", kPaths).size(), 0u);
}

/// What an .npy file says of itself, and its data.
struct Npy {
  std::string header, data;
};
Npy read_npy(const std::string& path) {
  const std::string bytes = read_bytes(path);
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  if (bytes.size() < 10) return {};
  const std::size_t length =
      static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
  EXPECT_EQ((10 + length) % 64, 0u);
  EXPECT_EQ(bytes[10 + length - 1], '\n');
  return {bytes.substr(10, length), bytes.substr(10 + length)};
}

TEST_F(QueryAnswers, NpyFilesOfAnyNumberOfRows) {
  const std::string rays = "8,23.3,33.1,4,0,0\n8,20.3,33.1,4,0,0\n8,23.3,33.1,1,0,0,\n";
  write_bytes("rays.csv", rays.substr(0, rays.size() - 2) + "\n");
  const auto query = [&](const std::string& answer) {
    const RunResult result =
        tet({"query", "box.tet", "--rays", "rays.csv", "--hits", "out.npy", "--answer", answer});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_npy("out.npy");
  };
  const Npy all = query("all");
  EXPECT_NE(
      all.header.find("{'descr': [('ray', '<i8'), ('hit', '<i4'), ('triangle', '<i4'), ('t', '<f8'), "
                      "('u', '<f8'), ('v', '<f8'), ('side', '<i4'), ('tet', '<i4'), ('neighbor', '<i4'), "
                      "('region', '<i4'), ('beyond', '<i4'), ('length', '<f8')], 'fortran_order': False, "
                      "'shape': (4,), }"),
      std::string::npos)
      << all.header;
  constexpr std::size_t kRow = 8 + 4 + 4 + 3 * 8 + 3 * 4 + 2 * 4 + 8;
  ASSERT_EQ(all.data.size(), 4 * kRow);
  const auto value = [&](std::size_t row, std::size_t offset, auto number) {
    std::memcpy(&number, all.data.data() + row * kRow + offset, sizeof number);
    return number;
  };
  const std::int64_t ray[] = {0, 0, 2, 2};
  const double length[] = {2, INFINITY, 2, INFINITY};
  for (std::size_t row = 0; row < 4; ++row) {
    EXPECT_EQ(value(row, 0, std::int64_t{}), ray[row]);
    EXPECT_EQ(value(row, 8, std::int32_t{}), static_cast<std::int32_t>(row % 2));
    EXPECT_EQ(value(row, kRow - 8, double{}), length[row]);
    EXPECT_EQ(value(row, kRow - 16, std::int32_t{}), static_cast<std::int32_t>(row % 2));      // region
    EXPECT_EQ(value(row, kRow - 12, std::int32_t{}), static_cast<std::int32_t>(1 - row % 2));  // beyond
  }
  const Npy paths = query("paths");
  EXPECT_NE(paths.header.find("'shape': (5,)"), std::string::npos) << paths.header;
  EXPECT_EQ(paths.data.size(), 5u * 20);
  const Npy any = query("any");
  EXPECT_NE(any.header.find("[('blocked', '<i4')]"), std::string::npos) << any.header;
  EXPECT_EQ(any.data, std::string("\1\0\0\0\0\0\0\0\1\0\0\0", 12));
}

// How many rows there are is only known at the end, and a pipe's beginning is gone by then.
TEST_F(QueryAnswers, PipesTakeCsvOnly) {
  write_bytes("rays.csv", "8,23.3,33.1,4,0,0\n");
  const RunResult npy = shell(
      "mkfifo out.npy; cat out.npy > copy & \"$TET\" query box.tet --rays rays.csv --hits out.npy --answer "
      "all; "
      "status=$?; wait; exit $status");
  EXPECT_EQ(npy.exit_code, 2);
  EXPECT_TRUE(is_one_line(npy.err, "tet query", {"out.npy", "go back", "name a file"}));
  const RunResult csv = shell(
      "mkfifo out.csv; cat out.csv > copy & \"$TET\" query box.tet --rays rays.csv --hits out.csv --answer "
      "all; "
      "status=$?; wait; exit $status");
  EXPECT_EQ(csv.exit_code, 0) << csv.err;
  EXPECT_EQ(table(read_bytes("copy"), kAll).size(), 2u);
}

#ifdef TET_HAS_CONVERTER
// Sixty sheets one above the other: more rows than a block of rays may hold in memory.
TEST_F(QueryAnswers, RaysOfManyCrossings) {
  constexpr int kSheets = 60, kRays = 4000;
  std::ostringstream obj;
  for (int i = 0; i < kSheets; ++i) {
    for (const char* corner : {"0 0", "10 0", "10 10", "0 10"}) obj << "v " << corner << ' ' << i << '\n';
    obj << "f -4 -3 -2 -1\n";
  }
  write_bytes("sheets.obj", obj.str());
  ASSERT_EQ(tet({"convert", "sheets.obj", "-o", "sheets.tet"}).exit_code, 0);
  std::vector<std::array<double, 6>> rays(kRays, {3.25, 6.5, -1, 0, 0, 1});
  for (std::size_t i = 0; i < rays.size(); ++i) rays[i][0] += static_cast<double>(i) / 1024;
  write_bytes("rays.npy", npy_bytes<float>(rays));
  for (const std::string threads : {"1", "4"}) {
    const RunResult result = tet({"query", "sheets.tet", "--rays", "rays.npy", "--hits",
                                  "out" + threads + ".csv", "--answer", "all", "--threads", threads});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  const std::string out = read_bytes("out1.csv");
  EXPECT_EQ(read_bytes("out4.csv"), out);
  EXPECT_GT(out.size(), std::size_t{12} << 20);
  const auto all = table(out, kAll);
  ASSERT_EQ(all.size(), static_cast<std::size_t>(kSheets * kRays));
  for (int i = 0; i < kSheets * kRays; ++i) {
    const Line& line = all[static_cast<std::size_t>(i)];
    ASSERT_EQ(line[0], std::to_string(i / kSheets));
    ASSERT_EQ(line[1], std::to_string(i % kSheets));
    ASSERT_EQ(to_double(line[3]), i % kSheets + 1);
  }
}
#endif

}  // namespace
}  // namespace tetfmt_test
