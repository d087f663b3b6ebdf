// SPDX-License-Identifier: AGPL-3.0-or-later
// Malformed files of rays: each a line that says what and where, exit code 3, and no output file.
#include <cmath>

#include "cli/cli_support.hpp"
#include "cli/npy_bytes.hpp"

namespace tetfmt_test {
namespace {

struct Malformed {
  std::string contents;
  std::vector<std::string> message;  ///< what the line must mention
  int exit_code = 3;
};

class RayFileTest : public CliTest {
 protected:
  void expect_refused(const std::string& name, const Malformed& file) {
    write_mesh("box.tet", box_mesh());
    write_bytes(name, file.contents);
    const RunResult result = tet({"query", "box.tet", "--rays", name, "--hits", "hits.npy"});
    EXPECT_EQ(result.exit_code, file.exit_code) << file.contents.substr(0, 200);
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(is_one_line(result.err, "tet query", file.message)) << file.contents.substr(0, 200);
    EXPECT_EQ(listing(), (std::vector<std::string>{"box.tet", name}));
  }
};

TEST_F(RayFileTest, MalformedCsvIsRefusedByLineAndColumn) {
  const std::vector<Malformed> files = {
      {"1,2,3,4,5\n", {"rays.csv:1", "found 5 columns", "expected 6"}},
      {"1,2,3,4,5,6,7\n", {"rays.csv:1", "found 7 columns"}},
      {"0 0 10 0 0 -1\n", {"rays.csv:1", "found 1 column"}},
      {"0;0;10;0;0;-1\n1,2,3,4,5,6\n", {"rays.csv:1", "found 1 column"}},
      {"ox oy oz dx dy dz\n1,2,3,4,5,6\n", {"rays.csv:1", "found 1 column"}},
      {"x,y,z\n1,2,3,4,5,6\n", {"rays.csv:1", "found 3 columns"}},
      {"ox,oy,oz,dx,dy,1\n1,2,3,4,5,6\n", {"rays.csv:1", "column 1 (ox)", "'ox'"}},
      {"ox,oy,oz,dx,dy,-.5m\n1,2,3,4,5,6\n", {"rays.csv:1", "column 1 (ox)", "'ox'"}},
      {"nan,nan,nan,nan,nan,nan\n", {"rays.csv:1", "column 1 (ox)", "'nan'"}},
      {"1 2 3 4 5 6\n", {"rays.csv:2", "found 1 column"}},
      {"# comment\n\nox,oy,oz,dx,dy,dz\n1,2,3,4,5,6\n1,2,three,4,5,6\n",
       {"rays.csv:5", "column 3 (oz)", "'three'"}},
      {"1,2,3,4,5,6\nox,oy,oz,dx,dy,dz\n", {"rays.csv:2", "column 1 (ox)", "'ox'"}},
      {"1,2,3,4,5,nan\n", {"rays.csv:1", "column 6 (dz)", "'nan'"}},
      {"1,-inf,3,4,5,6\n", {"rays.csv:1", "column 2 (oy)", "'-inf'"}},
      {"1,2,3,4,5,1e999\n", {"rays.csv:1", "column 6 (dz)"}},
      {"1,2,,4,5,6\n", {"rays.csv:1", "column 3 (oz)", "''"}},
      {"1,2,3,4,5,6,\n", {"rays.csv:1", "found 7 columns"}},
      {"1,2,0x3,4,5,6\n", {"rays.csv:1", "column 3 (oz)", "'0x3'"}},
      {"1,2,3 3,4,5,6\n", {"rays.csv:1", "column 3 (oz)", "'3 3'"}},
      {std::string("1,2,3\0,4,5,6\n", 13), {"rays.csv:1", "column 3 (oz)", "3\\x00"}},
      {"1,2,3,4,5,6\n1e300,2,3,4,5,6\n", {"rays.csv:2", "too large for float32"}},
      {"1,2,3,4,5,6\n1,2,3,4,-1e39,6\n", {"rays.csv:2", "too large for float32"}},
      // Eight columns, or six, but the same on every line.
      {"1,2,3,4,5,6,7,8,9\n", {"rays.csv:1", "found 9 columns", "or 8 with t_min,t_max"}},
      {"1,2,3,4,5,6\n1,2,3,4,5,6,0,1\n", {"rays.csv:2", "found 8 columns", "expected 6 as on line 1"}},
      {"# comment\nox,oy,oz,dx,dy,dz,t_min,t_max\n1,2,3,4,5,6\n",
       {"rays.csv:3", "found 6 columns", "expected 8 as on line 2"}},
      {"1,2,3,4,5,6,0,\n", {"rays.csv:1", "column 8 (t_max)", "''", "or inf"}},
      {"1,2,3,4,5,6,nan,1\n", {"rays.csv:1", "column 7 (t_min)", "'nan'"}},
      {"1,2,3,4,5,6,-inf,1\n", {"rays.csv:1", "column 7 (t_min)", "'-inf'"}},
      {"1,2,3,4,5,6,0,nan\n", {"rays.csv:1", "column 8 (t_max)", "'nan'", "or inf"}},
      {"1,2,3,4,5,6,0,-inf\n", {"rays.csv:1", "column 8 (t_max)", "'-inf'"}},
  };
  for (Malformed file : files) {
    if (file.contents.starts_with("1 2 3")) file.contents.insert(0, "1,2,3,4,5,6\n");
    expect_refused("rays.csv", file);
  }
}

TEST_F(RayFileTest, StandardInputIsNamed) {
  write_mesh("box.tet", box_mesh());
  const RunResult result = tet({"query", "box.tet", "--rays", "-", "--hits", "-"}, "1,2,3,4,5,6\n1,2\n");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_TRUE(is_one_line(result.err, "tet query", {"standard input:2", "found 2 columns"}));
}

TEST_F(RayFileTest, MalformedNpyIsRefused) {
  const std::array<double, 6> row{1, 2, 3, 4, 5, 6};
  const std::string whole = npy_bytes<float>({row, row, row});
  const auto header = [](const std::string& text) { return npy_with_header(text) + std::string(48, '\0'); };
  auto not_finite = row, infinite = row;
  not_finite[4] = NAN;
  infinite[0] = -INFINITY;
  const std::vector<Malformed> files = {
      {"", {"rays.npy", "not a .npy file"}},
      {"1,2,3,4,5,6\n", {"rays.npy", "not a .npy file"}},
      {"\x93NUMPY", {"rays.npy", "cut inside"}},
      {whole.substr(0, 9), {"rays.npy", "cut inside"}},
      {whole.substr(0, 60), {"rays.npy", "cut inside"}},
      {std::string("\x93NUMPY\x02\x00\x76\x00", 10), {"rays.npy", "cut inside"}},
      {std::string("\x93NUMPY\x02\x00\xFF\xFF\xFF\xFF{}", 14), {"rays.npy", "cut inside"}},
      {std::string("\x93NUMPY\x04\x00\x02\x00{}", 12), {"rays.npy", "version 4.0"}, 5},
      {whole.substr(0, whole.size() - 1), {"rays.npy", "3 rows", "71 bytes"}},
      {whole + "x", {"rays.npy", "3 rows", "73 bytes"}},
      {npy_with_header("{'descr': '<f4', 'fortran_order': False, 'shape': (768614336404564651, 6), }"),
       {"rays.npy", "768614336404564651 rows",
        "0 bytes"}},  // 24 bytes a row: wraps around 2^64 to a small number
      {npy_with_header("{'descr': '<f4', 'fortran_order': False, 'shape': (18446744073709551615, 6), }"),
       {"rays.npy", "rows"}},
      {npy_with_header("{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999999, 6), }"),
       {"rays.npy", "below 2^64"}},
      {header("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }"), {"(2, 3)", "(n, 6) or (n, 8)"}},
      {header("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 7), }"), {"(2, 7)", "(n, 6) or (n, 8)"}},
      {header("{'descr': '<f4', 'fortran_order': False, 'shape': (6,), }"), {"(6,)", "(n, 6)"}},
      {header("{'descr': '<f4', 'fortran_order': False, 'shape': (), }"), {"()", "(n, 6)"}},
      {header("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 1, 6), }"), {"(2, 1, 6)"}},
      {header("{'descr': '<f4', 'fortran_order': False, 'shape': (-2, 6), }"), {"malformed"}},
      {header("{'descr': '>f4', 'fortran_order': False, 'shape': (2, 6), }"), {">f4", "expected <f4"}},
      {header("{'descr': '<i4', 'fortran_order': False, 'shape': (2, 6), }"), {"<i4"}},
      {header("{'descr': '|O', 'fortran_order': False, 'shape': (2, 6), }"), {"|O"}},
      {header("{'descr': [('x', '<f4', (6,))], 'fortran_order': False, 'shape': (2,), }"),
       {"[('x', '<f4', (6,))]"}},
      {header("{'descr': [('x', '<f4', 'fortran_order': False"), {"malformed"}},
      {header("{'descr': '<f4', 'fortran_order': 0, 'shape': (2, 6), }"), {"fortran_order is neither"}},
      {header("{'descr': '<f4', 'shape': (2, 6), }"), {"missing"}},
      {header("{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (2, 6), }"), {"repeated"}},
      {header("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 6), 'more': 1}"), {"'more'"}},
      {header("{'descr': '<f4"), {"does not end"}},
      {header("(1, 2)"), {"malformed"}},
      {header(""), {"malformed"}},
      {npy_bytes<float>({row, not_finite}), {"rays.npy: ray 1", "column 4 (dy)", "nan"}},
      {npy_bytes<double>({infinite}), {"rays.npy: ray 0", "column 0 (ox)", "-inf"}},
      {npy_bytes<double>({row, {1, 2, 3, 1e39, 5, 6}}), {"rays.npy: ray 1", "too large for float32"}},
      {npy_bytes<float, 8>({{1, 2, 3, 4, 5, 6, 0, INFINITY}, {1, 2, 3, 4, 5, 6, 0, NAN}}),
       {"rays.npy: ray 1", "column 7 (t_max)", "nan", "or inf here"}},
      {npy_bytes<double, 8>({{1, 2, 3, 4, 5, 6, INFINITY, INFINITY}}),
       {"rays.npy: ray 0", "column 6 (t_min)", "inf", "must be finite"}},
  };
  for (const Malformed& file : files) expect_refused("rays.npy", file);
}

TEST_F(RayFileTest, EveryTruncationOfANpyIsRefused) {
  write_mesh("box.tet", box_mesh());
  const std::string whole = npy_bytes<float>({{13, 23, 10, 0, 0, 1}, {13, 23, 10, 0, 0, 1}});
  for (std::size_t length = 0; length < whole.size();
       length += length < 24 || length + 30 > whole.size() ? 1 : 7) {
    write_bytes("rays.npy", std::string_view(whole).substr(0, length));
    const RunResult result = tet({"query", "box.tet", "--rays", "rays.npy", "--hits", "hits.npy"});
    EXPECT_EQ(result.exit_code, 3) << length;
    EXPECT_TRUE(is_one_line(result.err, "tet query", {"rays.npy"})) << length;
  }
  EXPECT_FALSE(std::filesystem::exists("hits.npy"));
}

TEST_F(RayFileTest, UnreadableRaysAreInputErrors) {
  write_mesh("box.tet", box_mesh());
  std::filesystem::create_directory("folder.npy");
  for (const std::string name : {"missing.npy", "missing.csv", "folder.npy"}) {
    const RunResult result = tet({"query", "box.tet", "--rays", name, "--hits", "hits.npy"});
    EXPECT_EQ(result.exit_code, 2) << name;
    EXPECT_TRUE(is_one_line(result.err, "tet query", {name}));
  }
  EXPECT_EQ(listing(), (std::vector<std::string>{"box.tet", "folder.npy"}));
}

}  // namespace
}  // namespace tetfmt_test
