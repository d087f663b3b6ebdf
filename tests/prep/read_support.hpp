// SPDX-License-Identifier: AGPL-3.0-or-later
// What the readers' tests share.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "prep/prep_support.hpp"
#include "prep/read_soup.hpp"

namespace tetprep_test {

using Triangles = std::vector<std::array<Index, 3>>;
using Points = std::vector<std::array<double, 3>>;

inline const Points kCorners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

class Read : public FolderTest {
 protected:
  /// Expects `bytes` to be refused with this code, the file's name and `parts` in the message.
  void refuse(const std::string& name, std::string_view bytes, std::vector<std::string> parts,
              tetprep::ExitCode code = tetprep::ExitCode::invalid) {
    const std::string file = write(name, bytes);
    const auto failure = failure_of([&] { tetprep::read_soup(file); });
    EXPECT_EQ(failure.code(), code) << failure.what();
    parts.push_back(name);
    EXPECT_TRUE(mentions(failure.what(), parts));
  }

  /// Reads a file of this name and contents.
  TriangleSoup read_text(const std::string& name, std::string_view bytes) {
    return tetprep::read_soup(write(name, bytes));
  }
};

/// Every cut and every changed byte of `good` ends in a sound surface or in a Failure.
inline void expect_soundness(const std::function<TriangleSoup(std::string_view)>& read,
                             const std::string& good) {
  const auto check = [&](std::string_view bytes) {
    try {
      const TriangleSoup soup = read(bytes);
      ASSERT_FALSE(soup.triangles.empty());
      const tetprep::Appearance& a = soup.appearance;
      for (const auto& triangle : soup.triangles)
        for (const Index corner : triangle) {
          ASSERT_LT(corner, soup.points.size());
          for (const double x : soup.points[corner]) ASSERT_TRUE(std::isfinite(x));
        }
      for (const auto& corners : a.corners)
        for (const Index point : corners) ASSERT_TRUE(point == tetprep::kNone || point < a.surface_points);
      ASSERT_TRUE(a.corners.empty() || a.corners.size() == soup.triangles.size());
      ASSERT_TRUE(a.normals.empty() || a.normals.size() == a.surface_points);
      ASSERT_TRUE(a.texcoords.empty() || a.texcoords.size() == a.surface_points);
      ASSERT_TRUE(a.colors.empty() || a.colors.size() == a.surface_points);
      for (const auto& property : a.properties) ASSERT_EQ(property.values.size(), a.surface_points);
      ASSERT_TRUE(a.triangle_material.empty() || a.triangle_material.size() == soup.triangles.size());
      for (const Index material : a.triangle_material) ASSERT_LT(material, a.materials.size());
      ASSERT_FALSE(a.objects.empty());
      ASSERT_TRUE(a.triangle_object.empty() || a.triangle_object.size() == soup.triangles.size());
      for (const Index object : a.triangle_object) ASSERT_LT(object, a.objects.size());
    } catch (const tetprep::Failure& failure) {
      ASSERT_EQ(std::string_view(failure.what()).find('\n'), std::string_view::npos);
    }
  };
  for (std::size_t length = 0; length < good.size(); ++length)
    check(std::string_view(good).substr(0, length));
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const int change : {0x01, 0x08, 0x55, 0x80, 0xFF}) {
      std::string bad = good;
      bad[i] = static_cast<char>(bad[i] ^ change);
      check(bad);
    }
  }
}

/// The same of a file's contents.
inline void expect_soundness(const std::string& name, const std::string& good) {
  expect_soundness([&](std::string_view bytes) { return tetprep::parse_soup(name, bytes); }, good);
}

template <class T>
std::string raw(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

}  // namespace tetprep_test
