// SPDX-License-Identifier: AGPL-3.0-or-later
// What `tet query` can be asked about a ray, and how each answer becomes rows of a table.
#pragma once

#include <cstdint>
#include <span>

#include "tet/answer_file.hpp"
#include "tetfmt/traverse.hpp"

namespace tetprep {

enum class Answer {
  first,  ///< the first crossing: one row a ray
  any,    ///< whether there is one: one row a ray
  all,    ///< every crossing in order: any number of rows a ray
  paths,  ///< the length in every region: any number of rows a ray
};

std::span<const Column> columns_of(Answer answer);

/// True if every ray has exactly one row.
constexpr bool one_row_a_ray(Answer answer) {
  return answer == Answer::first || answer == Answer::any;
}

struct Asked {
  const tetfmt::FileView& view;
  const tetfmt::Location& from;
  std::int64_t number = 0;  ///< of the ray
  tetfmt::Vec3f direction;
  tetfmt::Interval interval;
  tetfmt::Kernel kernel = tetfmt::Kernel::exact;  ///< others answer Answer::first only
};

enum class Answered {
  fully,
  corrupt,  ///< the walk met bytes that are no mesh; no row was added
  absent,   ///< the ray starts in space that the file leaves out
  lost,     ///< only the float kernel could not answer
};

/// Adds the rows that answer one ray.
Answered answer_ray(Answer answer, const Asked& asked, Rows& rows);

/// The same for an answer that is there, by exact signs: to Answer::first, and to Answer::any.
Answered add_row(const tetfmt::Hit& hit, Rows& rows);
Answered add_row(tetfmt::Outcome outcome, Rows& rows);

}  // namespace tetprep
