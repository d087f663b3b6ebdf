// SPDX-License-Identifier: AGPL-3.0-or-later
// Holds what the library answers against the truth.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/scene.hpp"
#include "bench/tally.hpp"
#include "tetfmt/traverse.hpp"

namespace tetbench {

/// What is wrong with an answer.
struct Finding {
  Fault fault{};
  std::string text;
};

/// A place as the library has it and as the truth sees it.
struct Start {
  tetfmt::Location location;
  Place place;
  tetfmt::Index side = tetfmt::kNone;  ///< the side of a face that it is on
};

class Judge {
 public:
  /// `scene` must outlive the judge.
  explicit Judge(const Scene& scene);

  Start start(const tetfmt::Location& location, const tetfmt::Vec3f& point) const;
  Start start_on_side(const tetfmt::Location& location, tetfmt::Index side) const;

  /// Whether the place's tetrahedron contains it; of a side, whether it is exactly in the plane and between
  /// the edges of the face.
  std::optional<Finding> location(const Start& start) const;
  std::optional<Finding> side_location(const Start& start, const tetfmt::Hit& hit) const;

  /// `truth`: the crossings in the interval, of which only the first counts. Adds t's error to `tally`.
  std::optional<Finding> first_hit(const ExactLine& line, const Start& start,
                                   const tetfmt::Interval& interval, std::span<const Crossing> truth,
                                   const tetfmt::Hit& hit, Tally& tally) const;
  std::optional<Finding> all_hits(const ExactLine& line, const Start& start, const tetfmt::Interval& interval,
                                  std::span<const Crossing> truth, tetfmt::Outcome outcome,
                                  std::span<const tetfmt::Hit> hits, Tally& tally) const;
  /// A peer's answer: an input triangle or kNone. `all`: every crossing of the ray. Right if the triangle is
  /// that of the first crossing, or if the ray touches it, unperturbed, no later. A miss is one only where
  /// the line crosses the inside of a face, or starts inside of a closed surface.
  void peer(const ExactLine& line, std::span<const Crossing> all, tetfmt::Index triangle,
            PeerTally& tally) const;

  /// The input triangle that a side of a face is of.
  tetfmt::Index triangle_of(tetfmt::Index side) const { return input_triangle(side / 2); }

 private:
  std::optional<Finding> hit(const ExactLine& line, const tetfmt::Interval& interval, const Crossing& truth,
                             const tetfmt::Hit& hit, Tally& tally) const;
  std::string weights(const ExactLine& line, const Face& face, const tetfmt::Hit& hit) const;
  tetfmt::Index input_triangle(std::uint32_t face) const;

  const Scene& scene_;
  std::vector<std::array<tetfmt::Index, 3>> hull_;    ///< normals outwards
  std::vector<std::vector<std::uint32_t>> faces_of_;  ///< of each input triangle, if a peer is asked
};

}  // namespace tetbench
