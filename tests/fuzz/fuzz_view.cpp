// SPDX-License-Identifier: AGPL-3.0-or-later
// Any bytes through everything that promises to survive any bytes: open, validate, reconstruct, and every
// operation of traverse.hpp on a checked view, from places that the file's own last bytes choose as well as
// from invented ones. Then once more with the hashes made to match, so that mutations get past the checksums
// to the levels behind them. A file that validates is traced without checks as well, by every variant of the
// walk, and must agree.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "fuzz/fuzz_support.hpp"
#include "support/same.hpp"
#include "tetfmt/encode.hpp"
#include "tetfmt/kernels.hpp"
#include "tetfmt/reconstruct.hpp"
#include "tetfmt/traverse.hpp"
#include "tetfmt/validate.hpp"
#include "tetfmt/view.hpp"

namespace {

using namespace tetfmt_test;
using tetfmt::Outcome;

struct Question {
  tetfmt::Ray ray;
  tetfmt::Interval interval;
};

/// A few rays around the file's own bounds, whatever those are, and two made of the input's last bytes.
std::vector<Question> questions_for(const tetfmt::FileView& view) {
  const auto& [low, high] = view.bounds();
  std::vector<Question> questions = {
      {{low, {1, 1, 1}}, {}},
      {{high, {-1, -1, -1}}, {0, 2}},
      {{{low.x - 1, low.y, low.z}, {1, 0, 0}}, {1, 3}},
      {{{low.x / 2 + high.x / 2, low.y / 2 + high.y / 2, low.z / 2 + high.z / 2}, {0.25F, -0.5F, 0.125F}},
       {}},
      {{{0, 0, 0}, {0, 0, 0}}, {}},
  };
  const auto bytes = view.bytes();
  Reader reader(bytes.last(std::min<std::size_t>(bytes.size(), 96)));
  for (int i = 0; i < 2; ++i) {
    const tetfmt::Vec3f origin = reader.take_vector(), direction = reader.take_vector();
    const double t_min = reader.take_end(), t_max = reader.take_end();
    questions.push_back({{origin, direction}, {t_min, t_max}});
  }
  return questions;
}

/// Everything that may be asked from a place. No walk takes more steps than the file has tetrahedra, but one.
template <class View>
struct Answers {
  Answers(const View& view, const tetfmt::FileView& file, const tetfmt::Location& from,
          const tetfmt::Location& other, const Question& question) {
    const auto& [ray, interval] = question;
    first = tetfmt::first_hit(view, from, ray.direction);
    bounded = tetfmt::first_hit(view, from, ray.direction, interval);
    rough = tetfmt::first_hit(view, from, ray.direction, {}, tetfmt::Kernel::float_only);
    outcomes[0] = tetfmt::occlusion(view, from, ray.direction, interval);
    outcomes[1] = tetfmt::occlusion(view, from, other);
    outcomes[2] = tetfmt::occlusion(view, other, from);
    outcomes[3] = tetfmt::all_hits(view, from, ray.direction, hits);
    Reader reader(file.bytes().last(std::min<std::size_t>(file.bytes().size(), 72)));
    const std::vector<tetfmt::Vec3f> directions = fan(ray.direction, reader);
    together.resize(directions.size());
    (void)tetfmt::first_hits(view, from, directions, together);
    for (const tetfmt::Hit* hit : {&first, &bounded, &rough}) require(hit->steps <= file.tet_count() + 1);
    require(hits.size() <= file.tet_count() + 1);
  }
  bool same_as(const Answers<tetfmt::FileView>& other) const {
    return same(first, other.first) && same(bounded, other.bounded) && same(rough, other.rough) &&
           outcomes == other.outcomes && same(hits, other.hits) && same(together, other.together);
  }
  tetfmt::Hit first, bounded, rough;
  std::array<Outcome, 4> outcomes{};
  std::vector<tetfmt::Hit> hits, together;
};

void ask(const tetfmt::FileView& view, const tetfmt::TrustedView* trusted, const tetfmt::Location& from,
         const tetfmt::Location& other, const Question& question) {
  const Answers<tetfmt::FileView> answers(view, view, from, other, question);
  if (!trusted) return;
  require(Answers<tetfmt::TrustedView>(*trusted, view, from, other, question).same_as(answers));
  require(answers.first.outcome != Outcome::corrupt && answers.bounded.outcome != Outcome::corrupt);
  for (const Outcome outcome : answers.outcomes) require(outcome != Outcome::corrupt);
  require(same_but_for_steps(answers.together[0], answers.first));
  for (const auto basis : {tetfmt::Basis::shear, tetfmt::Basis::orthonormal, tetfmt::Basis::specialised}) {
    for (const auto arithmetic : {tetfmt::Arithmetic::exact, tetfmt::Arithmetic::float_first}) {
      const tetfmt::Variant variant{arithmetic, basis};
      require(same(tetfmt::first_hit(*trusted, from, question.ray.direction, variant), answers.first));
    }
  }
}

/// A place and a hit that nobody made, of indices that exist more often than not.
tetfmt::Location invented_place(const tetfmt::FileView& view, Reader& reader, const tetfmt::Vec3f& point) {
  const auto index = [&](std::size_t count) {
    const auto value = reader.take<std::uint32_t>();
    return value % 4 == 0 || count == 0 ? value : static_cast<tetfmt::Index>(value % count);
  };
  tetfmt::Location place;
  place.state = static_cast<tetfmt::Location::State>(reader.take<std::uint8_t>() % 4);
  place.position = {point.x, point.y, point.z};
  if (reader.take<std::uint8_t>() % 2 == 0)  // any doubles, which no place that was located has
    for (double& x : place.position) x = reader.take<double>();
  place.cell.tet = index(view.tet_count());
  for (auto& id : place.cell.vertices) id = index(view.vertices().size());
  for (auto& ref : place.cell.neighbors) ref = index(view.tet_count());
  place.positive = reader.take<std::uint8_t>() % 2 == 0;
  place.face = reader.take<std::uint8_t>() % 8;
  place.entrance_count = reader.take<std::uint16_t>();
  for (auto& entrance : place.entrances) entrance = reader.take<std::uint16_t>();
  return place;
}
tetfmt::Hit invented_hit(const tetfmt::FileView& view, Reader& reader) {
  tetfmt::Hit hit;
  hit.outcome = Outcome::hit;
  hit.side = reader.take<std::uint32_t>() % static_cast<tetfmt::Index>(view.sides().size() + 2);
  for (auto& id : hit.face)
    id = reader.take<std::uint32_t>() % static_cast<tetfmt::Index>(view.vertices().size() + 1);
  hit.side_u = reader.take<double>();
  hit.side_v = reader.take<double>();
  return hit;
}

void examine(std::span<const std::byte> bytes) {
  const tetfmt::Limits limits;
  const tetfmt::Report report = tetfmt::validate(bytes, tetfmt::Level::geometry, limits);
  const auto opened = tetfmt::FileView::open(bytes, limits);
  if (!opened) {
    require(!report.valid());
    return;
  }
  const tetfmt::FileView& view = *opened;
  const auto mesh = tetfmt::reconstruct(view);
  require(static_cast<bool>(mesh) || !report.valid());

  const auto trusted = tetfmt::TrustedView::validated(bytes, tetfmt::Level::geometry, limits);
  require(static_cast<bool>(trusted) == report.valid());
  const tetfmt::TrustedView* const sure = trusted ? &*trusted : nullptr;
  tetfmt::Location before;
  for (const Question& question : questions_for(view)) {
    const tetfmt::Location start = tetfmt::locate(view, question.ray.origin);
    if (before.state == tetfmt::Location::State::corrupt) before = start;
    require(!sure || same(tetfmt::locate(*sure, question.ray.origin), start));
    ask(view, sure, start, before, question);
    const tetfmt::Hit hit = tetfmt::first_hit(view, start, question.ray.direction);
    for (const tetfmt::Location& side : {tetfmt::near_side(view, hit), tetfmt::far_side(view, hit)}) {
      if (hit.outcome == Outcome::hit) ask(view, sure, side, start, question);
    }
    before = start;
  }
  // Places that do not fit the file: for checked views only.
  Reader reader(bytes.last(std::min<std::size_t>(bytes.size(), 256)));
  const Question question = questions_for(view).back();
  const tetfmt::Location place = invented_place(view, reader, question.ray.origin);
  ask(view, nullptr, place, before, question);
  (void)tetfmt::locate(view, question.ray.direction, &place.cell);
  const tetfmt::Hit hit = invented_hit(view, reader);
  ask(view, nullptr, tetfmt::near_side(view, hit), place, question);
  ask(view, nullptr, tetfmt::far_side(view, hit), place, question);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // A copy, because a view wants 8-byte alignment and the fuzzer's buffer promises none.
  std::vector<std::byte> bytes(size);
  if (size != 0) std::memcpy(bytes.data(), data, size);
  examine(bytes);
  tetfmt::rehash(bytes);
  examine(bytes);
  return 0;
}
