// SPDX-License-Identifier: AGPL-3.0-or-later
// The whole conversion, from file to file.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <thread>

#include "prep/hilbert.hpp"
#include "prep/pipeline.hpp"
#include "prep/prep_support.hpp"
#include "tetfmt/mapped_file.hpp"
#include "tetfmt/reconstruct.hpp"
#include "tetfmt/traverse.hpp"
#include "tetfmt/validate.hpp"

namespace tetprep_test {
namespace {

using tetfmt::Layout;
using tetprep::convert;
using tetprep::ConvertOptions;
using tetprep::ConvertReport;
using tetprep::ExitCode;

class Convert : public FolderTest {
 protected:
  ConvertReport run(const std::string& input, const std::string& output, Layout layout = Layout::tet20,
                    unsigned threads = 2, const std::string& report = {}) {
    ConvertOptions options;
    options.inputs = {input};
    options.output = path(output);
    options.layout = layout;
    options.threads = threads;
    if (!report.empty()) options.report = path(report);
    tetprep::Progress progress;
    return convert(options, progress);
  }

  tetfmt::Mesh reconstructed(const std::string& name) {
    auto file = tetfmt::MappedFile::open(path(name));
    EXPECT_TRUE(file);
    EXPECT_TRUE(tetfmt::validate(file->bytes()).valid());
    const auto view = tetfmt::FileView::open(file->bytes());
    auto mesh = tetfmt::reconstruct(*view);
    EXPECT_TRUE(mesh);
    return *mesh;
  }
};

TEST_F(Convert, RoundTrip) {
  const TriangleSoup soup = join(ball(9), moved(cube({0, 0, 0}, 1), {3, 0, 0}));
  const std::string input = write("in.obj", as_obj(soup));
  const ConvertReport report = run(input, "a.tet");
  run(input, "b.tet", Layout::tet16);
  EXPECT_EQ(listing(), (std::vector<std::string>{"a.tet", "b.tet", "in.obj"}));
  const tetfmt::Mesh mesh = reconstructed("a.tet"), other = reconstructed("b.tet");
  EXPECT_EQ(mesh.tets, other.tets);
  EXPECT_EQ(mesh.vertices, other.vertices);
  EXPECT_EQ(report.tets, mesh.tets.size());
  EXPECT_EQ(report.hull_faces, 12u);
  EXPECT_EQ(report.output_bytes, read("a.tet").size());

  // Triangles come in input order, with the input's corners in the input's order.
  ASSERT_EQ(mesh.triangles.size(), soup.triangles.size());
  const double tolerance = report.max_deviation * 1.0001;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const tetfmt::Vec3f v = mesh.vertices[mesh.triangles[t].vertices[i]];
      const auto& p = soup.points[soup.triangles[t][i]];
      EXPECT_LE(
          std::hypot(mesh.origin[0] + v.x - p[0], mesh.origin[1] + v.y - p[1], mesh.origin[2] + v.z - p[2]),
          tolerance);
    }
}

TEST_F(Convert, OrderInvariants) {
  run(write("in.obj", as_obj(ball(9))), "a.tet");
  const tetfmt::Mesh mesh = reconstructed("a.tet");
  // Faces are numbered as the tets come.
  Index next = 0;
  for (const auto& tet : mesh.tets) {
    std::set<Index> fresh;
    for (const tetfmt::Ref ref : tet.neighbors)
      if (tetfmt::is_side(ref) && tetfmt::side_index(ref) / 2 >= next)
        fresh.insert(tetfmt::side_index(ref) / 2);
    for (const Index face : fresh) EXPECT_EQ(face, next++);
  }
  EXPECT_EQ(next * 2, mesh.sides.size());
  // Outside of a closed surface that points outward lies the front: the source tet is inside, as is the
  // middle.
  EXPECT_EQ(mesh.sources.size(), 1u);
  const auto file = tetfmt::MappedFile::open(path("a.tet"));
  const auto view = tetfmt::FileView::open(file->bytes());
  const auto middle = tetfmt::locate(*view, {0, 0, 0});
  ASSERT_EQ(middle.state, tetfmt::Location::State::inside);
  const auto hit = tetfmt::first_hit(*view, middle, {1, 0.1f, 0.2f});
  EXPECT_EQ(hit.outcome, tetfmt::Outcome::hit);
  EXPECT_TRUE(hit.back);
  // Neighbours in the file are neighbours in space: far less than the 2 / 3 of random order.
  double jump = 0;
  for (std::size_t i = 1; i < mesh.tets.size(); ++i) {
    const auto &p = mesh.vertices[mesh.tets[i - 1].vertices[0]], &q = mesh.vertices[mesh.tets[i].vertices[0]];
    jump += std::hypot(p.x - q.x, p.y - q.y, p.z - q.z);
  }
  EXPECT_LT(jump / static_cast<double>(mesh.tets.size()), 0.5);
}

TEST_F(Convert, OptimizingChangesNoHit) {
  ConvertOptions options;
  options.inputs = {write("in.obj", as_obj(join(ball(12), moved(ball(7), {2.5, 0.25, 0}))))};
  tetprep::Progress progress;
  std::vector<tetfmt::Result<tetfmt::MappedFile>> files;
  std::vector<tetfmt::TrustedView> views;
  for (const auto optimize : {tetprep::Optimize::none, tetprep::Optimize::fast, tetprep::Optimize::best}) {
    options.optimize = optimize;
    options.output = path(std::to_string(files.size()) + ".tet");
    convert(options, progress);
    files.push_back(tetfmt::MappedFile::open(options.output));
    views.push_back(*tetfmt::TrustedView::validated(files.back()->bytes()));
  }
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-2, 4);
  std::array<double, 3> steps{};
  for (int i = 0; i < 2000; ++i) {
    const tetfmt::Vec3f from{place(random), place(random), place(random)},
        to{place(random), place(random), place(random)};
    const tetfmt::Vec3f direction{to.x - from.x, to.y - from.y, to.z - from.z};
    std::array<tetfmt::Hit, 3> hits;
    for (std::size_t k = 0; k < 3; ++k) {
      hits[k] = tetfmt::first_hit(views[k], tetfmt::locate(views[k], from), direction);
      steps[k] += hits[k].steps;
      EXPECT_EQ(hits[k].outcome, hits[0].outcome);
      EXPECT_EQ(hits[k].triangle, hits[0].triangle);
      EXPECT_EQ(hits[k].t, hits[0].t);
    }
  }
  EXPECT_LT(steps[1], steps[0]);
  EXPECT_LT(steps[2], steps[1]);
}

TEST(Hilbert, VisitsNeighboursInTurn) {
  // The curve through the 16 x 16 x 16 corner of the cube: every step goes to a neighbour, none twice.
  constexpr std::uint32_t n = 16;
  std::vector<std::pair<std::uint64_t, std::array<std::uint32_t, 3>>> places;
  for (std::uint32_t x = 0; x < n; ++x)
    for (std::uint32_t y = 0; y < n; ++y)
      for (std::uint32_t z = 0; z < n; ++z)
        places.push_back({tetprep::hilbert_position({x, y, z}), {x, y, z}});
  std::sort(places.begin(), places.end());
  for (std::size_t i = 1; i < places.size(); ++i) {
    int distance = 0;
    for (std::size_t k = 0; k < 3; ++k)
      distance += std::abs(static_cast<int>(places[i].second[k]) - static_cast<int>(places[i - 1].second[k]));
    EXPECT_EQ(distance, 1);
    EXPECT_EQ(places[i].first, i);
  }
}

TEST_F(Convert, SameBytesForAnyThreads) {
  const std::string input = write("in.obj", as_obj(ball(25)));
  run(input, "one.tet", Layout::tet20, 1);
  run(input, "two.tet", Layout::tet20, 2);
  run(input, "again.tet", Layout::tet20, 2);
  EXPECT_EQ(read("one.tet"), read("two.tet"));
  EXPECT_EQ(read("two.tet"), read("again.tet"));
}

TEST_F(Convert, FarFromTheOrigin) {
  const TriangleSoup near = cube({0, 0, 0}, 4);
  const std::array<double, 3> far{1048576.25, -3e7, 12345.5};
  run(write("near.obj", as_obj(near)), "near.tet");
  run(write("far.obj", as_obj(moved(near, far))), "far.tet");
  const tetfmt::Mesh mesh = reconstructed("far.tet");
  for (std::size_t t = 0; t < near.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const tetfmt::Vec3f v = mesh.vertices[mesh.triangles[t].vertices[i]];
      const auto& p = near.points[near.triangles[t][i]];
      EXPECT_EQ(mesh.origin[0] + v.x, p[0] + far[0]);
      EXPECT_EQ(mesh.origin[1] + v.y, p[1] + far[1]);
      EXPECT_EQ(mesh.origin[2] + v.z, p[2] + far[2]);
    }
  EXPECT_EQ(mesh.tets.size(), reconstructed("near.tet").tets.size());
}

TEST_F(Convert, DroppedTrianglesKeepTheirPlace) {
  TriangleSoup soup = cube({0, 0, 0}, 1);
  soup.triangles.insert(soup.triangles.begin() + 3, {0, 0, 1});
  soup.triangles.push_back(soup.triangles[0]);
  const ConvertReport report = run(write("in.obj", as_obj(soup)), "a.tet");
  EXPECT_EQ(report.degenerate_triangles, 1u);
  EXPECT_EQ(report.duplicate_triangles, 1u);
  const tetfmt::Mesh mesh = reconstructed("a.tet");
  ASSERT_EQ(mesh.triangles.size(), 14u);
  for (std::size_t t = 0; t < 14; ++t) EXPECT_EQ(mesh.triangles[t].dropped(), t == 3 || t == 13) << t;
}

TEST_F(Convert, ReportIsJson) {
  run(write("in.obj", as_obj(ball(5))), "a.tet", Layout::tet16, 1, "report.json");
  const auto json = nlohmann::json::parse(read("report.json"));
  EXPECT_EQ(json["options"]["layout"], "tet16");
  EXPECT_EQ(json["surface"]["input_triangles"], 300);
  EXPECT_EQ(json["result"]["bytes"], read("a.tet").size());
  EXPECT_EQ(json["result"]["hull_faces"], 12);
  EXPECT_EQ(json["tetgen"]["switches"], "pYQq5");
  std::set<std::string> stages;
  for (const auto& stage : json["stages"]) {
    stages.insert(stage["name"]);
    EXPECT_GE(stage["seconds"], 0);
    EXPECT_GT(stage["peak_memory_mb"], 0);
  }
  for (const char* name : {"read", "snap", "tetrahedralize", "order", "encode", "validate", "write",
                           "tetgen: delaunay", "tetgen: boundary recovery"})
    EXPECT_TRUE(stages.contains(name)) << name;
}

TEST_F(Convert, FailuresLeaveNothing) {
  const std::string good = write("good.obj", as_obj(cube({0, 0, 0}, 1)));
  const std::string flat = write("flat.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n");
  const std::string old = write("old.tet", "what was there before");
  const auto before = listing();
  const auto code_of = [&](const std::string& input, const std::string& output,
                           const std::string& report = {}) {
    const auto failure = failure_of([&] { run(input, output, Layout::tet20, 2, report); });
    EXPECT_EQ(listing(), before) << failure.what();
    return failure.code();
  };
  EXPECT_EQ(code_of(flat, "old.tet"), ExitCode::invalid);
  EXPECT_EQ(code_of(path("missing.obj"), "out.tet"), ExitCode::io);
  EXPECT_EQ(code_of(good, "no/such/folder/out.tet"), ExitCode::io);
  EXPECT_EQ(code_of(good, ""), ExitCode::io) << "a directory";
  EXPECT_EQ(code_of(good, "good.obj"), ExitCode::usage);
  EXPECT_EQ(code_of(good, "out.tet", "no/such/folder/report.json"), ExitCode::io);
  EXPECT_EQ(read("old.tet"), "what was there before");
}

TEST_F(Convert, ReplacedOutputKeepsItsPermissions) {
  namespace fs = std::filesystem;
  const std::string old = write("x.tet", "old");
  const auto mode = fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_write;
  fs::permissions(old, mode);
  run(write("in.obj", as_obj(cube({0, 0, 0}, 1))), "x.tet");
  EXPECT_EQ(fs::status(old).permissions(), mode);
  EXPECT_NE(read("x.tet"), "old");
}

TEST_F(Convert, NoFileServesTwice) {
  const std::string input = write("in.obj", as_obj(cube({0, 0, 0}, 1)));
  const std::string before = read("in.obj");
  std::filesystem::create_hard_link(input, path("link.obj"));
  const auto refused = [&](const std::string& output, const std::string& report) {
    const auto failure = failure_of([&] { run(input, output, Layout::tet20, 1, report); });
    EXPECT_EQ(failure.code(), ExitCode::usage) << failure.what();
    EXPECT_EQ(listing(), (std::vector<std::string>{"in.obj", "link.obj"}));
    EXPECT_EQ(read("in.obj"), before);
  };
  refused("x.tet", "in.obj");
  refused("x.tet", "link.obj");
  refused("x.tet", "x.tet");
  refused("x.tet", "./x.tet");
  refused("./in.obj", "");
}

TEST_F(Convert, FailedReportLeavesNoOutput) {
  ConvertOptions options;
  options.inputs = {write("in.obj", as_obj(cube({0, 0, 0}, 1)))};
  options.output = path("x.tet");
  options.report = "/dev/full";
  tetprep::Progress progress;
  EXPECT_EQ(failure_of([&] { convert(options, progress); }).code(), ExitCode::io);
  EXPECT_EQ(listing(), (std::vector<std::string>{"in.obj"}));
  options.output = options.report = "/dev/null";
  EXPECT_NO_THROW(convert(options, progress));
}

TEST_F(Convert, ReportTellsOfFailures) {
  const std::string input = write("in.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n");
  const auto failure = failure_of([&] { run(input, "x.tet", Layout::tet20, 2, "report.json"); });
  EXPECT_EQ(failure.code(), ExitCode::invalid);
  EXPECT_EQ(listing(), (std::vector<std::string>{"in.obj", "report.json"}));
  const auto json = nlohmann::json::parse(read("report.json"));
  EXPECT_EQ(json["error"], failure.what());
  EXPECT_EQ(json["exit_code"], 3);
  EXPECT_EQ(json["outcome"], "invalid");
  EXPECT_EQ(json["surface"]["input_triangles"], 1);
}

TEST_F(Convert, IntersectionsAreCutAndListed) {
  const std::string input = write("in.obj", as_obj(join(cube({0, 0, 0}, 8), cube({4, 4, 4}, 8))));
  run(input, "x.tet", Layout::tet20, 2, "report.json");
  const auto json = nlohmann::json::parse(read("report.json"));
  EXPECT_EQ(json["outcome"], "ok (cut)");
  EXPECT_EQ(json["intersections"].size(), json["intersection_count"]);
  EXPECT_GT(json["intersections"].size(), 5u);
  for (const auto& pair : json["intersections"]) {
    EXPECT_LT(pair[0], 12);
    EXPECT_GE(pair[1], 12);
    EXPECT_LT(pair[1], 24);
  }
  const tetfmt::Mesh mesh = reconstructed("x.tet");
  EXPECT_EQ(mesh.triangles.size(), json["surface"]["triangles"]);
  EXPECT_GT(mesh.triangles.size(), 24u);
  // Each piece says of which of the input's triangles it is one, and so do hits: from within both cubes, the
  // first thing that is met along x is the first cube's side.
  const auto origins = std::find_if(mesh.optional.begin(), mesh.optional.end(),
                                    [](const auto& section) { return section.kind == tetfmt::kOrigins; });
  ASSERT_NE(origins, mesh.optional.end());
  EXPECT_EQ(origins->bytes.size(), mesh.triangles.size() * sizeof(Index));
}

TEST_F(Convert, ThreadsAndRunsMakeNoDifferenceToCutPartialScenes) {
  ConvertOptions options;
  options.inputs = {write("a.obj", as_obj(ball(12))),
                    write("b.obj", as_obj(moved(ball(11), {0.5, 0.25, 0.125}))),
                    write("c.obj", as_obj(moved(cube({0, 0, 0}, 0.3), {3, 3, 3})))};
  options.keep = tetprep::Keep::outside;
  std::set<std::string> results;
  for (const unsigned threads : {1, 2, 3, 2}) {
    options.threads = threads;
    options.output = path("x.tet");
    tetprep::Progress progress;
    const ConvertReport report = convert(options, progress);
    EXPECT_EQ(report.regions.count, 5u);
    EXPECT_EQ(report.regions.kept, 1u);
    results.insert(read("x.tet"));
  }
  EXPECT_EQ(results.size(), 1u);
}

TEST_F(Convert, OutsideRaysNeedOnlyTheOutside) {
  ConvertOptions options;
  options.inputs = {write("a.obj", as_obj(ball(20))),
                    write("b.obj", as_obj(moved(ball(13), {2.5, 0.25, 0.125})))};
  const auto converted = [&](tetprep::Keep keep, const std::string& name) {
    options.keep = keep;
    options.output = path(name);
    tetprep::Progress progress;
    convert(options, progress);
    auto file = tetfmt::MappedFile::open(path(name));
    EXPECT_TRUE(tetfmt::validate(file->bytes()).valid());
    return std::move(*file);
  };
  const auto whole = converted(tetprep::Keep::all, "whole.tet");
  const auto partial = converted(tetprep::Keep::outside, "partial.tet");
  const auto all = tetfmt::FileView::open(whole.bytes()), some = tetfmt::FileView::open(partial.bytes());
  EXPECT_LT(some->header().tet_count, all->header().tet_count * 3 / 4);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-4, 6);
  std::size_t hits = 0;
  for (int i = 0; i < 20'000; ++i) {
    const auto point = [&] { return tetfmt::Vec3f{place(random), place(random), place(random)}; };
    const tetfmt::Vec3f from = point(), to = point();
    if (std::hypot(from.x, from.y, from.z) < 1 ||
        std::hypot(from.x - 2.5f, from.y - 0.25f, from.z - 0.125f) < 1)
      continue;
    const tetfmt::Ray ray{from, {to.x - from.x, to.y - from.y, to.z - from.z}};
    const auto a = tetfmt::first_hit(*all, tetfmt::locate(*all, from), ray.direction);
    const auto b = tetfmt::first_hit(*some, tetfmt::locate(*some, from), ray.direction);
    ASSERT_EQ(a.outcome, b.outcome);
    hits += a.outcome == tetfmt::Outcome::hit;
    if (a.outcome != tetfmt::Outcome::hit) continue;
    ASSERT_EQ(a.triangle, b.triangle);
    ASSERT_EQ(a.t, b.t);
    ASSERT_EQ(a.back, b.back);
  }
  EXPECT_GT(hits, 1000u);
}

TEST_F(Convert, CoarserGridsOnRequestOnly) {
  const TriangleSoup soup = ball(7);
  const auto fine = tetprep::snap(soup), coarse = tetprep::snap(soup, 4);
  EXPECT_EQ(coarse.grid_exponent, fine.grid_exponent + 4);
  EXPECT_EQ(coarse.triangles.size(), fine.triangles.size());
  const double step = std::ldexp(1.0, coarse.grid_exponent);
  EXPECT_GT(coarse.max_deviation, step / 4);
  EXPECT_LE(coarse.max_deviation, step * 0.8661);  // half a cell's diagonal
}

TEST(FallbackNote, NamesFailuresAndWhatWasUsed) {
  tetprep::TetrahedralizeReport report;
  report.switches = "pYQ";
  EXPECT_EQ(tetprep::fallback_note(report), "");
  report.failed_attempts.push_back({"pYQq5", "ran out of time"});
  EXPECT_TRUE(mentions(tetprep::fallback_note(report), {"-pYQq5", "ran out of time", "used -pYQ instead"}));
}

TEST_F(Convert, TrianglesSmallerThanTheGrid) {
  std::string text;
  for (const char* x : {"0", "1000000"})
    text += std::string("v ") + x + " 0 0\nv " + x + " 0.001 0\nv " + x + " 0 0.001\nf -3 -2 -1\n";
  const std::string input = write("in.obj", text);
  const auto failure = failure_of([&] { run(input, "x.tet"); });
  EXPECT_EQ(failure.code(), ExitCode::invalid);
  EXPECT_TRUE(mentions(failure.what(), {"none of the 2 triangles", "smaller than the grid step 0.5"}));
}

TEST_F(Convert, FullDisk) {
  ConvertOptions options;
  options.inputs = {write("in.obj", as_obj(cube({0, 0, 0}, 1)))};
  options.output = "/dev/full";
  tetprep::Progress progress;
  const auto failure = failure_of([&] { convert(options, progress); });
  EXPECT_EQ(failure.code(), ExitCode::io);
  EXPECT_TRUE(mentions(failure.what(), {"/dev/full", "space"}));
}

/// Tells where the work is, by a byte in a pipe.
class Beacon : public tetprep::Progress {
 public:
  Beacon(int descriptor, std::string stage) : descriptor_(descriptor), stage_(std::move(stage)) {}
  void stage(std::string_view name) override {
    if (name == stage_ && write(descriptor_, "x", 1) < 0) _exit(2);
  }

 private:
  int descriptor_;
  std::string stage_;
};

TEST_F(Convert, InterruptLeavesNothing) {
  const std::string input = write("in.obj", as_obj(ball(80)));
  for (const int signal : {SIGINT, SIGTERM}) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t worker = fork();
    if (worker == 0) {
      ConvertOptions options;
      options.inputs = {input};
      options.output = path("out.tet");
      Beacon beacon(ends[1], "tetgen: boundary recovery");
      convert(options, beacon);
      _exit(0);
    }
    char byte = 0;
    ASSERT_EQ(::read(ends[0], &byte, 1), 1);
    kill(worker, signal);
    int status = 0;
    waitpid(worker, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal);
    EXPECT_EQ(listing(), (std::vector<std::string>{"in.obj"}));
    close(ends[0]);
    close(ends[1]);
  }
}

}  // namespace
}  // namespace tetprep_test
