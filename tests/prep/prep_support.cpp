// SPDX-License-Identifier: AGPL-3.0-or-later
#include "prep/prep_support.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "common/parse.hpp"
#include "prep/box.hpp"

namespace tetprep_test {

void FolderTest::SetUp() {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  folder_ = std::filesystem::temp_directory_path() /
            ("prep-" + std::to_string(getpid()) + "-" + test->test_suite_name() + "-" + test->name());
  std::filesystem::create_directories(folder_);
}

void FolderTest::TearDown() {
  std::filesystem::remove_all(folder_);
}

std::string FolderTest::write(const std::string& name, std::string_view bytes) const {
  std::ofstream(path(name), std::ios::binary) << bytes;
  return path(name);
}

std::string FolderTest::read(const std::string& name) const {
  std::ifstream in(path(name), std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> FolderTest::listing() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

tetprep::Failure failure_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const tetprep::Failure& failure) {
    EXPECT_EQ(std::string(failure.what()).find('\n'), std::string::npos) << failure.what();
    return failure;
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another exception: " << error.what();
    return {tetprep::ExitCode::ok, "not a Failure"};
  }
  ADD_FAILURE() << "no failure";
  return {tetprep::ExitCode::ok, "no failure"};
}

::testing::AssertionResult mentions(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    if (text.find(part) == std::string::npos)
      return ::testing::AssertionFailure() << "no \"" << part << "\" in: " << text;
  return ::testing::AssertionSuccess();
}

TriangleSoup cube(const std::array<double, 3>& low, double edge) {
  TriangleSoup soup;
  for (std::size_t i = 0; i < 8; ++i) {
    soup.points.push_back(low);
    for (std::size_t k = 0; k < 3; ++k)
      if ((i >> k & 1) != 0) soup.points.back()[k] += edge;
  }
  soup.triangles.assign(tetprep::Box::kTriangles.begin(), tetprep::Box::kTriangles.end());
  return soup;
}

TriangleSoup join(TriangleSoup a, const TriangleSoup& b) {
  const auto shift = static_cast<Index>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({i + shift, j + shift, k + shift});
  return a;
}

TriangleSoup moved(TriangleSoup soup, const std::array<double, 3>& by) {
  for (auto& point : soup.points)
    for (std::size_t k = 0; k < 3; ++k) point[k] += by[k];
  return soup;
}

TriangleSoup ball(int n) {
  TriangleSoup soup;
  std::map<std::array<int, 3>, Index> ids;
  const auto id = [&](std::array<int, 3> p) {
    const auto [place, fresh] = ids.try_emplace(p, static_cast<Index>(soup.points.size()));
    if (fresh) {
      std::array<double, 3> q{2.0 * p[0] / n - 1, 2.0 * p[1] / n - 1, 2.0 * p[2] / n - 1};
      const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
      for (double& x : q) x /= length;
      soup.points.push_back(q);
    }
    return place->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> p{};
            p[axis] = side;
            p[(axis + 1) % 3] = i + di;
            p[(axis + 2) % 3] = j + dj;
            return id(p);
          };
          const Index a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (side == n) {
            soup.triangles.push_back({a, b, c});
            soup.triangles.push_back({a, c, d});
          } else {
            soup.triangles.push_back({a, c, b});
            soup.triangles.push_back({a, d, c});
          }
        }
  return soup;
}

std::string as_obj(const TriangleSoup& soup) {
  std::string text;
  for (const auto& [x, y, z] : soup.points)
    text += "v " + tetprep::number(x) + " " + tetprep::number(y) + " " + tetprep::number(z) + "\n";
  for (const auto& [a, b, c] : soup.triangles)
    text += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " + std::to_string(c + 1) + "\n";
  return text;
}

tetprep::TetMesh fill(tetprep::CleanSurface& surface, tetprep::TetrahedralizeReport* report) {
  tetprep::Progress progress;
  tetprep::StageLog log(progress);
  tetprep::TetrahedralizeReport unused;
  return tetprep::tetrahedralize(surface, {}, progress, log, report != nullptr ? *report : unused);
}

tetprep::TetMesh fill(const tetprep::CleanSurface& surface, tetprep::TetrahedralizeReport* report) {
  tetprep::CleanSurface copy = surface;
  tetprep::TetMesh mesh = fill(copy, report);
  EXPECT_EQ(copy.points, surface.points);
  EXPECT_EQ(copy.triangles, surface.triangles);
  return mesh;
}

void expect_sound(const tetprep::CleanSurface& surface, const tetprep::TetMesh& mesh) {
  ASSERT_GE(mesh.points.size(), surface.points.size() + 8);
  EXPECT_TRUE(std::equal(surface.points.begin(), surface.points.end(), mesh.points.begin()));
  EXPECT_EQ(std::set<tetprep::GridPoint>(mesh.points.begin(), mesh.points.end()).size(), mesh.points.size());
  std::vector<bool> used(mesh.points.size(), false);
  std::map<std::array<Index, 3>, int> faces;
  std::map<std::array<Index, 3>, int> constrained;
  __extension__ using Wide = __int128;
  Wide volume = 0;
  std::size_t hull = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& tet = mesh.tets[t];
    const auto& p = mesh.points;
    EXPECT_NE(tetfmt::orientation(p[tet[0]], p[tet[1]], p[tet[2]], p[tet[3]]), 0);
    std::array<std::array<Wide, 3>, 3> d{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) d[i][k] = p[tet[i + 1]][k] - p[tet[0]][k];
    const Wide det = d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) -
                     d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
                     d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
    volume += det < 0 ? -det : det;
    for (std::size_t k = 0; k < 4; ++k) {
      used[tet[k]] = true;
      std::array<Index, 3> face{};
      for (std::size_t i = 0, j = 0; i < 4; ++i)
        if (i != k) face[j++] = tet[i];
      std::sort(face.begin(), face.end());
      ++faces[face];
      const Index beyond = mesh.neighbors[t][k];
      if (beyond == tetprep::kNone) {
        ++hull;
        EXPECT_EQ(mesh.face_triangle[t][k], tetprep::kNone);
      } else {
        const auto& back = mesh.neighbors[beyond];
        EXPECT_EQ(std::count(back.begin(), back.end(), t), 1);
        for (const Index v : face)
          EXPECT_NE(std::find(mesh.tets[beyond].begin(), mesh.tets[beyond].end(), v),
                    mesh.tets[beyond].end());
      }
      if (const Index triangle = mesh.face_triangle[t][k]; triangle != tetprep::kNone) {
        auto expected = surface.triangles[triangle];
        std::sort(expected.begin(), expected.end());
        EXPECT_EQ(face, expected);
        ++constrained[face];
      }
    }
  }
  EXPECT_EQ(hull, 12u);
  EXPECT_EQ(constrained.size(), surface.triangles.size());
  for (const auto& [face, count] : constrained) EXPECT_EQ(count, 2);
  EXPECT_TRUE(std::all_of(used.begin(), used.end(), [](bool u) { return u; }));
  // The box is around the surface on the grid that it came on, which may have become finer.
  const tetprep::Box box{mesh.points[surface.points.size()], mesh.points[surface.points.size() + 7]};
  for (const tetprep::GridPoint& p : surface.points) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT(box.low[k], p[k]);
      EXPECT_GT(box.high[k], p[k]);
    }
  }
  EXPECT_EQ(mesh.origin, surface.origin);
  EXPECT_EQ(mesh.grid_exponent, surface.grid_exponent);
  Wide expected = 6;
  for (std::size_t k = 0; k < 3; ++k) expected *= box.high[k] - box.low[k];
  EXPECT_TRUE(volume == expected) << "the tets do not fill the box exactly";
}

}  // namespace tetprep_test
