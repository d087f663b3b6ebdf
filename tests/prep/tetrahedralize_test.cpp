// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <thread>

#include "prep/box.hpp"
#include "prep/describe.hpp"
#include "prep/prep_support.hpp"
#include "prep/tetgen_child.hpp"

namespace tetprep_test {
namespace {

using tetprep::CleanSurface;
using tetprep::ExitCode;
using tetprep::GridPoint;
using tetprep::kNone;
using tetprep::snap;
using tetprep::TetMesh;

void expect_filled(const TriangleSoup& soup) {
  CleanSurface surface = snap(soup);
  const TetMesh mesh = fill(surface);
  expect_sound(surface, mesh);
}

TEST(Tetrahedralize, Cube) {
  expect_filled(cube({0, 0, 0}, 1));
}
TEST(Tetrahedralize, NestedCubes) {
  expect_filled(join(cube({0, 0, 0}, 9), cube({3, 3, 3}, 3)));
}
TEST(Tetrahedralize, CubesWithACommonSide) {
  expect_filled(join(cube({0, 0, 0}, 1), cube({1, 0, 0}, 1)));
}
TEST(Tetrahedralize, Ball) {
  expect_filled(ball(12));
}
TEST(Tetrahedralize, FarFromTheOrigin) {
  expect_filled(moved(ball(6), {1e7, -1e7, 1e7}));
}

TEST(Tetrahedralize, OpenSquare) {
  TriangleSoup soup;
  soup.points = {{0, 0, 5}, {1, 0, 5}, {1, 1, 5}, {0, 1, 5}};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}};
  expect_filled(soup);
}

TEST(Tetrahedralize, SingleTriangle) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {0.3, 0.7, 0.1}};
  soup.triangles = {{0, 1, 2}};
  expect_filled(soup);
}

TEST(Tetrahedralize, FanAroundAnEdge) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {1, 1, 0.5}};
  for (Index i = 2; i < 7; ++i) soup.triangles.push_back({0, 1, i});
  expect_filled(soup);
}

TEST(Tetrahedralize, CrossedSlabs) {  // Schoenhardt-like: boundary recovery has to add points of its own
  TriangleSoup soup;
  for (int i = 0; i < 6; ++i) {
    const double a = i, far = 20;
    const auto base = static_cast<Index>(soup.points.size());
    if (i % 2 == 0) {
      soup.points.insert(soup.points.end(),
                         {{-far, a, 2 * a}, {far, a, 2 * a + 1}, {0, a + 0.3, 2 * a + 0.2}});
    } else {
      soup.points.insert(soup.points.end(),
                         {{a, -far, 2 * a}, {a, far, 2 * a + 1}, {a + 0.3, 0, 2 * a + 0.2}});
    }
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  expect_filled(soup);
}

std::vector<tetprep::TrianglePair> intersections_of(CleanSurface surface) {
  try {
    fill(surface);
  } catch (const tetprep::Intersecting& intersecting) {
    return intersecting.pairs;
  }
  return {};
}

TEST(Tetrahedralize, IntersectionsAreHandedOutAndNamed) {
  CleanSurface surface = snap(join(cube({0, 0, 0}, 8), cube({4, 4, 4}, 8)));
  const auto pairs = intersections_of(surface);
  ASSERT_FALSE(pairs.empty());
  for (const auto& [a, b] : pairs) {
    EXPECT_LT(a, 12u);
    EXPECT_GE(b, 12u);
  }
  EXPECT_TRUE(mentions(tetprep::describe_intersections(surface, pairs),
                       {"intersects itself", std::to_string(pairs.size()) + " pairs", " and ", "(4 4 4)"}));
}

TEST(Tetrahedralize, InputNumbersAreNamed) {
  TriangleSoup soup = join(cube({0, 0, 0}, 8), cube({4, 4, 4}, 8));
  soup.triangles.insert(soup.triangles.begin(), 100, {0, 0, 1});  // dropped, but they count
  CleanSurface surface = snap(soup);
  const auto pairs = intersections_of(surface);
  ASSERT_FALSE(pairs.empty());
  const std::string text = tetprep::describe_intersections(surface, pairs);
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(mentions(text, {" " + std::to_string(i) + " ("}));
}

TEST(Tetrahedralize, TimeIsLimited) {
  CleanSurface surface = snap(ball(60));
  tetprep::Progress progress;
  tetprep::StageLog log(progress);
  tetprep::TetrahedralizeReport report;
  tetprep::TetrahedralizeOptions options;
  options.time_limit = 1e-3;
  const auto failure = failure_of([&] { tetprep::tetrahedralize(surface, options, progress, log, report); });
  EXPECT_EQ(failure.code(), ExitCode::runtime);
  EXPECT_TRUE(mentions(failure.what(), {"no end", "pYQ"}));
}

void add(TriangleSoup& soup, const tetprep::Point& a, const tetprep::Point& b, const tetprep::Point& c) {
  const auto base = static_cast<Index>(soup.points.size());
  soup.points.insert(soup.points.end(), {a, b, c});
  soup.triangles.push_back({base, base + 1, base + 2});
}

constexpr double kSteps = 1 << 21;  // of the grid, over the whole extent

/// Numbers below `most`, the same on every machine.
struct Numbers {
  std::uint32_t state = 1;
  double below(double most) {
    state = state * 1664525u + 1013904223u;
    return std::floor(most * (state >> 8) / (1 << 24));
  }
};

/// Checks that the pieces of a cut surface are what they should be.
void expect_pieces(const CleanSurface& before, const CleanSurface& after) {
  ASSERT_EQ(after.input_corners.size(), before.input_triangle_count);
  const double step = std::ldexp(1.0, before.grid_exponent - after.grid_exponent);
  const auto at = [&](const CleanSurface& surface, Index v, std::size_t k) {
    return surface.origin[k] + std::ldexp(surface.points[v][k], surface.grid_exponent);
  };
  for (std::size_t v = 0; v < before.points.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(at(before, static_cast<Index>(v), k), at(after, static_cast<Index>(v), k));
  const auto area = [&](const CleanSurface& surface, const std::array<Index, 3>& t) {
    std::array<double, 3> u{}, w{};
    for (std::size_t k = 0; k < 3; ++k) {
      u[k] = at(surface, t[1], k) - at(surface, t[0], k);
      w[k] = at(surface, t[2], k) - at(surface, t[0], k);
    }
    return std::array{u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]};
  };
  // The pieces' area vectors add up to the triangle's, to within the grid.
  std::map<Index, std::array<double, 3>> sums;
  for (std::size_t t = 0; t < after.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      sums[after.input_triangle[t]][k] += area(after, after.triangles[t])[k];
  ASSERT_EQ(sums.size(), before.triangles.size());
  for (std::size_t t = 0; t < before.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(sums[before.input_triangle[t]][k], area(before, before.triangles[t])[k],
                  8 * step * std::ldexp(kSteps, 2 * before.grid_exponent));
}

/// A stack of triangles from side to side, one step of the grid apart: edges in space that only points on
/// them let be edges of tets.
TriangleSoup stack(int count) {
  TriangleSoup soup;
  Numbers random;
  for (int i = 0; i < count; ++i) {
    const double z = i;
    const double a = random.below(kSteps), b = random.below(kSteps), c = random.below(kSteps);
    add(soup, {0, a, z}, {kSteps, b, z}, {c, random.below(kSteps), z});
  }
  return soup;
}

TEST(Tetrahedralize, StackOfSheetsOneStepApart) {
  CleanSurface surface = snap(stack(60));
  const CleanSurface before = surface;
  tetprep::TetrahedralizeReport report;
  const TetMesh mesh = fill(surface, &report);
  expect_sound(surface, mesh);
  EXPECT_GT(report.cut_triangles, 0u);
  EXPECT_LE(report.cut_deviation, 2 * std::ldexp(1.0, before.grid_exponent));
  EXPECT_GT(surface.triangles.size(), before.triangles.size());
  expect_pieces(before, surface);
}

TEST(Tetrahedralize, NeedleFan) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {0, 0, kSteps}};
  for (int i = 0; i < 50; ++i) {
    soup.points.push_back({kSteps, static_cast<double>(2 * i), kSteps / 2});  // 1e-6 radians apart
    soup.triangles.push_back({0, 1, static_cast<Index>(i + 2)});
  }
  expect_filled(soup);
}

TEST(Tetrahedralize, FiftySheetsAtAnEdge) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {0, 0, 1}};
  for (int i = 0; i < 50; ++i) {
    soup.points.push_back({std::cos(0.125 * i), std::sin(0.125 * i), 0.5});
    soup.triangles.push_back({0, 1, static_cast<Index>(i + 2)});
  }
  expect_filled(soup);
}

TEST(Tetrahedralize, SheetAndItsCopyOneStepAway) {
  TriangleSoup soup;
  constexpr int n = 12;
  for (int layer = 0; layer < 2; ++layer) {
    Numbers random;
    const auto base = static_cast<Index>(soup.points.size());
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j)
        soup.points.push_back({i * kSteps / 16, j * kSteps / 16, random.below(kSteps / 16) + layer});
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        const Index a = base + i * (n + 1) + j;
        soup.triangles.push_back({a, a + 1, a + n + 2});
        soup.triangles.push_back({a, a + n + 2, a + n + 1});
      }
    }
  }
  soup.points.push_back({kSteps, 0, 0});  // the extent, so that the grid is as fine as meant
  soup.points.push_back({kSteps, 1, 0});
  soup.points.push_back({kSteps, 0, 1});
  const auto last = static_cast<Index>(soup.points.size());
  soup.triangles.push_back({last - 3, last - 2, last - 1});
  expect_filled(soup);
}

TEST(Tetrahedralize, TinyPieces) {
  TriangleSoup soup;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      for (int k = 0; k < 6; ++k)
        soup = join(std::move(soup), cube({i * 349525.0, j * 349525.0, k * 349525.0}, 1));
  expect_filled(soup);
}

TEST(Tetrahedralize, MemoryIsLimited) {
  CleanSurface surface = snap(ball(24));
  tetprep::Progress progress;
  tetprep::StageLog log(progress);
  tetprep::TetrahedralizeReport report;
  tetprep::TetrahedralizeOptions options;
  options.memory_limit = 4'000'000;
  const auto failure = failure_of([&] { tetprep::tetrahedralize(surface, options, progress, log, report); });
  EXPECT_EQ(failure.code(), ExitCode::runtime);
  EXPECT_TRUE(mentions(failure.what(), {"needs more than 4 MB of memory", "stage"}));
  ASSERT_FALSE(report.failed_attempts.empty());
  options.memory_limit = 1'000'000'000;
  tetprep::tetrahedralize(surface, options, progress, log, report);
}

/// Remembers the shares of each stage.
struct Shares : tetprep::Progress {
  void stage(std::string_view) override { last = 0; }
  void fraction(double done) override {
    EXPECT_GE(done, last);
    EXPECT_LT(done, 1);
    last = done;
    ++count;
  }
  double last = 0;
  int count = 0;
};

TEST(Tetrahedralize, ProgressIsMonotone) {
  CleanSurface surface = snap(ball(24));
  Shares shares;
  tetprep::StageLog log(shares);
  tetprep::TetrahedralizeReport report;
  tetprep::tetrahedralize(surface, {}, shares, log, report);
  EXPECT_GT(shares.count, 0);
}

/// A surface and its box for a TetgenChild of its own.
struct ChildInput {
  CleanSurface surface = snap(ball(100));
  std::vector<GridPoint> points = surface.points;
  tetprep::Progress progress;
  ChildInput() {
    const auto corners = tetprep::box_around(points).corners();
    points.insert(points.end(), corners.begin(), corners.end());
  }
};

TEST(TetgenChild, KilledChildIsAReason) {
  ChildInput in;
  tetprep::TetgenChild child(in.points, in.surface.triangles, {"pYQ"});
  kill(child.pid(), SIGSEGV);
  const auto outcome = child.wait(60, in.progress, [] { return false; });
  EXPECT_FALSE(outcome.mesh);
  EXPECT_TRUE(mentions(outcome.reason, {"Segmentation fault", "stage"}));
}

TEST(TetgenChild, GivingUpKillsIt) {
  ChildInput in;
  tetprep::TetgenChild child(in.points, in.surface.triangles, {"pYQ"});
  const pid_t pid = child.pid();
  const auto outcome = child.wait(60, in.progress, [] { return true; });
  EXPECT_FALSE(outcome.mesh);
  EXPECT_EQ(kill(pid, 0), -1);
}

TEST(TetgenChild, DestructionKillsIt) {
  pid_t pid = 0;
  {
    ChildInput in;
    const tetprep::TetgenChild child(in.points, in.surface.triangles, {"pYQ"});
    pid = child.pid();
    EXPECT_EQ(kill(pid, 0), 0);
  }
  EXPECT_EQ(kill(pid, 0), -1);
}

TEST(TetgenChild, RefusedSwitchesAreAReason) {
  ChildInput in;
  tetprep::TetgenChild child(in.points, in.surface.triangles, {"pw"});
  const auto outcome = child.wait(60, in.progress, [] { return false; });
  EXPECT_FALSE(outcome.mesh);
  EXPECT_TRUE(mentions(outcome.reason, {"switches"}));
}

TEST(TetgenChild, IntersectingFacetsAreAReason) {
  // Without the search for intersections, TetGen's own complaint arrives as one.
  CleanSurface surface = snap(join(cube({0, 0, 0}, 8), cube({4, 4, 4}, 8)));
  tetprep::Progress progress;
  tetprep::TetgenChild child(surface.points, surface.triangles, {"pYQ"});
  const auto outcome = child.wait(60, progress, [] { return false; });
  EXPECT_FALSE(outcome.mesh);
  EXPECT_FALSE(outcome.reason.empty());
}

TEST(TetgenChild, DiesWithItsParent) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    ChildInput in;
    const tetprep::TetgenChild child(in.points, in.surface.triangles, {"pYQq1.1"});
    const pid_t pid = child.pid();
    if (write(ends[1], &pid, sizeof pid) < 0) _exit(2);
    kill(getpid(), SIGKILL);
  }
  pid_t pid = 0;
  ASSERT_EQ(read(ends[0], &pid, sizeof pid), static_cast<ssize_t>(sizeof pid));
  waitpid(parent, nullptr, 0);
  bool gone = false;
  for (int i = 0; i < 200 && !gone; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    // A process that nobody waits for yet still has an id: look at its state.
    char path[64], state = 'X';
    std::snprintf(path, sizeof path, "/proc/%d/stat", pid);
    if (FILE* file = std::fopen(path, "r")) {
      if (std::fscanf(file, "%*d %*s %c", &state) != 1) state = 'X';
      std::fclose(file);
    }
    gone = state == 'X' || state == 'Z';
  }
  EXPECT_TRUE(gone);
  close(ends[0]);
  close(ends[1]);
}

}  // namespace
}  // namespace tetprep_test
