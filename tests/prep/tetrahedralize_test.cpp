// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
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
