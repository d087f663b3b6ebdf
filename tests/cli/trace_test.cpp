// SPDX-License-Identifier: AGPL-3.0-or-later
// `tet trace`: the picture, pixel by pixel where geometry says what it must be.
#include <fcntl.h>
#include <png.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <set>
#include <thread>

#include "cli/cli_support.hpp"
#include "support/region_mesh.hpp"

namespace tetfmt_test {
namespace {

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> bytes;
  std::array<int, 3> at(int x, int y) const {
    const std::size_t i = 3 * static_cast<std::size_t>(y * width + x);
    return {bytes[i], bytes[i + 1], bytes[i + 2]};
  }
};

Picture read_png(const std::string& path) {
  Picture picture;
  png_image control{};
  control.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&control, path.c_str()) == 0) {
    ADD_FAILURE() << path << ": " << control.message;
    return picture;
  }
  control.format = PNG_FORMAT_RGB;
  picture.width = static_cast<int>(control.width);
  picture.height = static_cast<int>(control.height);
  picture.bytes.resize(PNG_IMAGE_SIZE(control));
  EXPECT_NE(png_image_finish_read(&control, nullptr, picture.bytes.data(), 0, nullptr), 0) << control.message;
  return picture;
}

/// Straight at the wall z = 4 of the inner box from z = 20 (local), one model unit about 3 pixels.
const std::vector<std::string> kFront = {"--size", "60x40", "--eye", "13,23,50", "--look-at", "13,23,33"};

Picture trace(const std::vector<std::string>& more, const std::string& file = "box.tet") {
  std::vector<std::string> arguments{"trace", file, "-o", "out.png"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const RunResult result = tet(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(is_one_line(result.err, "tet trace", {"out.png", "rays", "ns", "% hit", "at most"}));
  return read_png("out.png");
}

std::vector<std::string> with(std::vector<std::string> options, const std::vector<std::string>& more) {
  options.insert(options.end(), more.begin(), more.end());
  return options;
}

TEST_F(CliTest, TraceShowsNormalsAsColours) {
  write_mesh("box.tet", box_mesh());
  const Picture front = trace(with(kFront, {"--shade", "normal"}));
  ASSERT_EQ(front.width, 60);
  ASSERT_EQ(front.height, 40);
  EXPECT_EQ(front.at(30, 20), (std::array<int, 3>{128, 128, 255}));  // n = (0, 0, 1)
  EXPECT_NE(front.at(1, 1), front.at(30, 20));
  // From inside, the same wall still shows the triangle's own normal.
  const Picture inside =
      trace({"--shade", "normal", "--size", "9x9", "--eye", "13,23,33", "--look-at", "13,23,34"});
  EXPECT_EQ(inside.at(4, 4), (std::array<int, 3>{128, 128, 255}));
  const Picture left =
      trace({"--shade", "normal", "--size", "9x9", "--eye", "0,23.1,33.1", "--look-at", "13,23.1,33.1"});
  EXPECT_EQ(left.at(4, 4), (std::array<int, 3>{0, 128, 128}));  // n = (-1, 0, 0)
}

TEST_F(CliTest, TraceCameraIsTheRightWayRound) {
  write_mesh("box.tet", box_mesh());
  // Looking down -z past the box, so that it stands in the upper right quarter: +x is right, +y is up.
  const Picture picture = trace(
      {"--size", "40x40", "--eye", "11,21,50", "--look-at", "11,21,33", "--shade", "normal", "--fov", "20"});
  EXPECT_EQ(picture.at(33, 6), (std::array<int, 3>{128, 128, 255}));
  for (const auto& [x, y] : {std::pair{6, 6}, {6, 33}, {33, 33}})
    EXPECT_NE(picture.at(x, y), (std::array<int, 3>{128, 128, 255}));
}

TEST_F(CliTest, TraceFieldOfViewIsVertical) {
  write_mesh("box.tet", box_mesh());
  // The wall z = 4 is 2 wide at distance 16: half of it subtends atan(1 / 16) = 3.576 degrees.
  for (const std::string size : {"40x40", "80x40"}) {
    const Picture just = trace(
        {"--size", size, "--eye", "13,23,50", "--look-at", "13,23,33", "--shade", "normal", "--fov", "7.1"});
    EXPECT_EQ(just.at(just.width / 2, 0)[2], 255) << size;
    const Picture wider = trace(
        {"--size", size, "--eye", "13,23,50", "--look-at", "13,23,33", "--shade", "normal", "--fov", "8.2"});
    EXPECT_NE(wider.at(wider.width / 2, 0), just.at(just.width / 2, 0)) << size;
  }
}

TEST_F(CliTest, TraceDefaultCameraFramesTheSurface) {
  // The same box in lattices of very different extent, and far from the origin: the picture shows the
  // surface, not the tetrahedra around it.
  for (const int n : {4, 12}) {
    LatticeOptions options;
    options.low = n / 2 - 1;
    options.high = n / 2 + 1;
    options.origin = {1e6, -5, 3};
    write_mesh("box.tet", lattice_mesh(n, options));
    const Picture picture = trace({"--size", "100x100"});
    const auto background = [&](int x, int y) {
      const auto edge = picture.at(0, y);
      return picture.at(x, y) == edge;
    };
    int left = 100, right = 0, top = 100, bottom = 0;
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 100; ++x) {
        if (background(x, y)) continue;
        left = std::min(left, x), right = std::max(right, x), top = std::min(top, y),
        bottom = std::max(bottom, y);
      }
    }
    EXPECT_GE(left, 2) << n;
    EXPECT_LE(right, 97) << n;
    EXPECT_GE(top, 2) << n;
    EXPECT_LE(bottom, 97) << n;
    EXPECT_GE(std::max(right - left, bottom - top), 80) << n;
    EXPECT_NEAR(left + right, 99, 3) << n;
    EXPECT_NEAR(top + bottom, 99, 3) << n;
  }
}

TEST_F(CliTest, TraceAzimuthAndElevationTurnTheDefaultCamera) {
  write_mesh("box.tet", box_mesh());
  const auto middle = [&](const std::vector<std::string>& more) {
    return trace(with({"--size", "33x33", "--shade", "normal"}, more)).at(16, 16);
  };
  using Colour = std::array<int, 3>;
  EXPECT_EQ(middle({"--azimuth", "0", "--elevation", "0"}), (Colour{128, 128, 255}));   // front: +z
  EXPECT_EQ(middle({"--azimuth", "90", "--elevation", "0"}), (Colour{255, 128, 128}));  // its right: +x
  EXPECT_EQ(middle({"--azimuth", "180", "--elevation", "0"}), (Colour{128, 128, 0}));   // behind: -z
  EXPECT_EQ(middle({"--elevation", "89"}), (Colour{128, 255, 128}));                    // above: +y
  EXPECT_EQ(middle({"--azimuth", "0", "--elevation", "0", "--up", "0,0,1"}),
            (Colour{128, 0, 128}));  // -y if z is up
}

TEST_F(CliTest, TraceLambertSeparatesWallsAndBackground) {
  write_mesh("box.tet", box_mesh());
  const Picture picture = trace({"--size", "64x64"});
  std::set<std::array<int, 3>> colours;
  for (int y = 16; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) colours.insert(picture.at(x, y));
  }
  EXPECT_GE(colours.size(), 4u);  // two walls in the middle band at least, background, edges between
  for (const int channel : picture.at(0, 0)) EXPECT_GT(channel, 200);  // light background
}

TEST_F(CliTest, TraceDepthIsBrighterWhereNearer) {
  write_mesh("box.tet", box_mesh());
  const Picture picture =
      trace({"--size", "64x64", "--eye", "13,28,38", "--look-at", "13,23,33", "--shade", "depth"});
  const auto top_edge = picture.at(32, 32);
  EXPECT_GT(top_edge[0], picture.at(32, 52)[0]);
  EXPECT_EQ(picture.at(0, 0), (std::array<int, 3>{0, 0, 0}));
  int brightest = 0;
  for (const std::uint8_t channel : picture.bytes) brightest = std::max<int>(brightest, channel);
  EXPECT_GT(brightest, 240);
}

TEST_F(CliTest, TraceStepsRunFromPurpleToYellow) {
  write_mesh("box.tet", box_mesh());
  const Picture picture = trace({"--size", "64x64", "--eye", "13,23,60", "--look-at", "13,23,33", "--shade",
                                 "steps", "--samples", "1"});
  EXPECT_EQ(picture.at(0, 0), (std::array<int, 3>{68, 1, 84}));  // passes by the hull: no tet at all
  std::set<std::array<int, 3>> colours;
  for (int i = 0; i < 64 * 64; ++i) colours.insert(picture.at(i % 64, i / 64));
  EXPECT_EQ(colours.count({253, 231, 37}), 1u);  // the most
}

TEST_F(CliTest, TraceTellsHowRaysWereWalked) {
  write_mesh("box.tet", box_mesh());
  const auto summary = [](const std::vector<std::string>& more) {
    return tet(with(with({"trace", "box.tet", "-o", "out.png"}, kFront), more)).err;
  };
  const auto visits = [](const std::string& line) {
    const auto end = line.find(" tets visited a camera ray");
    return std::stod(line.substr(line.rfind(' ', end - 1)));
  };
  const std::string together = summary({}), steps = summary({"--shade", "steps"}),
                    floats = summary({"--kernel", "float"});
  EXPECT_NE(together.find("a camera ray, walked together;"), std::string::npos) << together;
  for (const std::string& alone : {steps, floats}) {
    EXPECT_NE(alone.find("a camera ray, at most "), std::string::npos) << alone;
    EXPECT_EQ(alone.find("together"), std::string::npos) << alone;
    EXPECT_LT(2 * visits(together), visits(alone));
  }
}

TEST_F(CliTest, TraceWritesPicturesByTheirNames) {
  write_mesh("box.tet", box_mesh());
  for (const auto& [name, magic] : std::vector<std::pair<std::string, std::string>>{
           {"a.png", "\x89PNG"}, {"a.PNG", "\x89PNG"}, {"a", "\x89PNG"}, {"a.exr", "\x76\x2f\x31\x01"}}) {
    EXPECT_EQ(tet({"trace", "box.tet", "-o", name, "--size", "8x8"}).exit_code, 0);
    EXPECT_EQ(read_bytes(name).substr(0, 4), magic);
    std::filesystem::remove(name);
  }
  for (const std::string name : {"a.jpg", "a.png.txt", "b.exr/../a.tif"}) {
    const RunResult result = tet({"trace", "box.tet", "-o", name, "--size", "8x8"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(is_one_line(result.err, "tet trace", {name, ".png", ".exr"})) << result.err;
  }
  EXPECT_EQ(listing(), std::vector<std::string>{"box.tet"});
}

TEST_F(CliTest, TraceSamplesSmoothEdges) {
  write_mesh("box.tet", box_mesh());
  const std::vector<std::string> view = {"--size",   "60x40", "--eye",   "13.3,23.2,50", "--look-at",
                                         "13,23,33", "--up",  "0.3,1,0", "--shade",      "normal"};
  const Picture rough = trace(with(view, {"--samples", "1"}));
  const Picture smooth = trace(with(view, {"--samples", "16"}));
  const auto between = [](const Picture& picture) {
    int count = 0;
    const auto wall = picture.at(30, 20);
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 60; ++x) count += picture.at(x, y) != wall && picture.at(x, y) != picture.at(0, y);
    }
    return count;
  };
  EXPECT_EQ(between(rough), 0);
  EXPECT_GT(between(smooth), 10);
}

TEST_F(CliTest, TraceIsTheSameForAnyNumberOfThreadsAndBothLayouts) {
  write_mesh("box.tet", box_mesh());
  write_mesh("box16.tet", box_mesh(), tetfmt::Layout::tet16);
  for (const std::string shade : {"lambert", "normal", "depth", "steps"}) {
    std::string expected;
    for (const std::string threads : {"1", "2", "5"}) {
      trace({"--size", "101x67", "--shade", shade, "--threads", threads});
      const std::string bytes = read_bytes("out.png");
      if (expected.empty()) expected = bytes;
      EXPECT_EQ(bytes, expected) << shade << " " << threads;
    }
    trace({"--size", "101x67", "--shade", shade}, "box16.tet");
    EXPECT_EQ(read_bytes("out.png"), expected) << shade;
    EXPECT_NE(expected.find("sRGB"), std::string::npos);
    EXPECT_EQ(expected.find("tIME"), std::string::npos);
  }
}

TEST_F(CliTest, TraceDrawsOpenSurfacesAndNone) {
  LatticeOptions options;
  options.low = 2;
  options.walls = 1u << 5;
  write_mesh("wall.tet", lattice_mesh(6, options));
  EXPECT_NE(trace({"--size", "32x32"}, "wall.tet").at(16, 16)[0], 0);
  options.walls = 0;
  write_mesh("none.tet", lattice_mesh(6, options));
  const Picture empty = trace({"--size", "32x32"}, "none.tet");
  EXPECT_EQ(empty.at(16, 16), empty.at(0, 16));
}

TEST_F(CliTest, TraceWithoutAViewDirectionIsAUsageError) {
  write_mesh("box.tet", box_mesh());
  for (const auto& camera : {std::vector<std::string>{"--eye", "1,2,3", "--look-at", "1,2,3"},
                             {"--eye", "13,50,33", "--look-at", "13,23,33", "--up", "0,1,0"}}) {
    const RunResult result = tet(with({"trace", "box.tet", "-o", "x.png"}, camera));
    EXPECT_EQ(result.exit_code, 1) << result.err;
    EXPECT_TRUE(is_one_line(result.err, "tet trace", {"--"}));
  }
  // Without --up, looking straight down is no mistake.
  EXPECT_EQ(
      trace({"--size", "9x9", "--shade", "normal", "--eye", "13,50,33", "--look-at", "13,23,33"}).at(4, 4),
      (std::array<int, 3>{128, 255, 128}));
  EXPECT_EQ(listing(), (std::vector<std::string>{"box.tet", "out.png"}));
}

TEST_F(CliTest, TraceRemovesItsTemporaryWhenInterrupted) {
  write_mesh("box.tet", box_mesh());
  for (const int signal : {SIGTERM, SIGINT}) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      execl(TET_BINARY, "tet", "trace", "box.tet", "-o", "x.png", "--size", "8000x8000", "--threads", "2",
            static_cast<char*>(nullptr));
      _exit(127);
    }
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (listing().size() < 2 && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    EXPECT_EQ(listing().size(), 2u);  // the temporary is there
    kill(child, signal);
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(WTERMSIG(status), signal);
    EXPECT_EQ(listing(), std::vector<std::string>{"box.tet"});
  }
}

TEST_F(CliTest, TraceNeverWritesOverItsInput) {
  write_mesh("box.tet", box_mesh());
  const std::string bytes = read_bytes("box.tet");
  for (const std::string output : {"box.tet", "./box.tet"}) {
    const RunResult result = tet({"trace", "box.tet", "-o", output});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(is_one_line(result.err, "tet trace", {output, "the input itself"}));
  }
  EXPECT_EQ(read_bytes("box.tet"), bytes);
  EXPECT_EQ(listing(), std::vector<std::string>{"box.tet"});
}

TEST_F(CliTest, TraceRefusesAbsurdCameras) {
  write_mesh("box.tet", box_mesh());
  for (const auto& [option, value] :
       std::vector<std::pair<std::string, std::string>>{{"--azimuth", "nan"},
                                                        {"--azimuth", "361"},
                                                        {"--elevation", "nan"},
                                                        {"--elevation", "90"},
                                                        {"--fov", "nan"},
                                                        {"--fov", "0"},
                                                        {"--eye", "nan,0,0"},
                                                        {"--eye", "1e31,0,0"},
                                                        {"--look-at", "0,-1e300,0"},
                                                        {"--up", "0,inf,0"},
                                                        {"--up", "0,0,1e31"}}) {
    const RunResult result = tet({"trace", "box.tet", "-o", "out.png", option, value});
    EXPECT_EQ(result.exit_code, 1) << option << ' ' << value;
    EXPECT_TRUE(is_one_line(result.err, "tet trace", {option, value}));
  }
  for (const std::string option : {"--azimuth", "--elevation"}) {
    const RunResult result = tet({"trace", "box.tet", "-o", "out.png", option, "10", "--eye", "1,2,3"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(is_one_line(result.err, "tet trace", {option, "--eye"}));
  }
  EXPECT_EQ(listing(), std::vector<std::string>{"box.tet"});
}

TEST_F(CliTest, TraceNeedsACameraInSpaceThatIsThere) {
  write_mesh("box.tet", with_regions(box_mesh(), {1}));
  const RunResult absent = tet({"trace", "box.tet", "-o", "out.png", "--size", "8x8"});
  EXPECT_EQ(absent.exit_code, 1);
  EXPECT_TRUE(is_one_line(absent.err, "tet trace", {"leaves out", "--eye", "--keep all"}));
  EXPECT_FALSE(std::filesystem::exists("out.png"));
  const Picture inside =
      trace({"--shade", "normal", "--size", "9x9", "--eye", "13,23,33", "--look-at", "13,23,34"});
  EXPECT_EQ(inside.at(4, 4), (std::array<int, 3>{128, 128, 255}));
}

}  // namespace
}  // namespace tetfmt_test
