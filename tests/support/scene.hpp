// SPDX-License-Identifier: AGPL-3.0-or-later
// A mesh in both layouts, checked and trusted: every answer is asked of all four and must be the same to the
// last bit.
#pragma once

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "support/lattice_mesh.hpp"
#include "support/region_mesh.hpp"
#include "support/same.hpp"
#include "tetfmt/encode.hpp"
#include "tetfmt/traverse.hpp"

namespace tetfmt_test {

struct Scene {
  explicit Scene(int n, const LatticeOptions& options = {}) : Scene(lattice_mesh(n, options)) {}
  explicit Scene(tetfmt::Mesh given)
      : mesh(std::move(given)),
        bytes20(tetfmt::encode(mesh, tetfmt::Layout::tet20)),
        bytes16(tetfmt::encode(mesh, tetfmt::Layout::tet16)),
        view20(*tetfmt::FileView::open(bytes20)),
        view16(*tetfmt::FileView::open(bytes16)),
        trusted20(*tetfmt::TrustedView::validated(bytes20)),
        trusted16(*tetfmt::TrustedView::validated(bytes16)) {}
  Scene(const Scene&) = delete;  // the views look at the bytes
  Scene& operator=(const Scene&) = delete;

  /// Calls ask(view) with all four views and returns the answer that they agree on, or the test fails.
  template <class Ask>
  auto by_all(Ask&& ask) const {
    const auto answer = ask(view20);
    EXPECT_TRUE(same(answer, ask(view16))) << "Tet16 answers differently";
    EXPECT_TRUE(same(answer, ask(trusted20))) << "a trusted view answers differently";
    EXPECT_TRUE(same(answer, ask(trusted16))) << "a trusted view of Tet16 answers differently";
    return answer;
  }
  tetfmt::Location locate(const tetfmt::Vec3f& point) const {
    return by_all([&](const auto& view) { return tetfmt::locate(view, point); });
  }
  tetfmt::Hit first_hit(const tetfmt::Location& from, const tetfmt::Vec3f& direction,
                        const tetfmt::Interval& interval = {}) const {
    return by_all([&](const auto& view) { return tetfmt::first_hit(view, from, direction, interval); });
  }
  tetfmt::Outcome occlusion(const tetfmt::Location& from, const tetfmt::Vec3f& direction,
                            const tetfmt::Interval& interval = {}) const {
    return by_all([&](const auto& view) { return tetfmt::occlusion(view, from, direction, interval); });
  }
  tetfmt::Outcome occlusion(const tetfmt::Location& from, const tetfmt::Location& to) const {
    return by_all([&](const auto& view) { return tetfmt::occlusion(view, from, to); });
  }
  struct AllHits {
    tetfmt::Outcome outcome;
    std::vector<tetfmt::Hit> hits;
    friend bool same(const AllHits& a, const AllHits& b) {
      return a.outcome == b.outcome && tetfmt_test::same(a.hits, b.hits);
    }
  };
  AllHits all_hits(const tetfmt::Location& from, const tetfmt::Vec3f& direction,
                   const tetfmt::Interval& interval = {}) const {
    return by_all([&](const auto& view) {
      AllHits all{};
      all.outcome = tetfmt::all_hits(view, from, direction, all.hits, interval);
      return all;
    });
  }
  /// On the side of the hit's face that the ray came from, or (far) on the side beyond.
  tetfmt::Location side_of(const tetfmt::Hit& hit, bool far) const {
    const auto on = [&](const tetfmt::FileView& view) {
      return far ? tetfmt::far_side(view, hit) : tetfmt::near_side(view, hit);
    };
    const tetfmt::Location location = on(view20);
    EXPECT_TRUE(same(location, on(view16)));
    return location;
  }

  tetfmt::Mesh mesh;
  std::vector<std::byte> bytes20, bytes16;
  tetfmt::FileView view20, view16;
  tetfmt::TrustedView trusted20, trusted16;
};

}  // namespace tetfmt_test
