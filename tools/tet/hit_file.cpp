// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tet/hit_file.hpp"

#include <cstring>
#include <limits>

#include "common/npy.hpp"
#include "common/parse.hpp"
#include "tet/ray_file.hpp"

namespace tetprep {
namespace {

constexpr const char* kDescr =
    "[('triangle', '<i4'), ('t', '<f8'), ('u', '<f8'), ('v', '<f8'), ('side', '<i4'), ('tet', '<i4'), "
    "('neighbor', '<i4')]";
constexpr const char* kCsvHeader = "triangle,t,u,v,side,tet,neighbor\n";

/// One hit in the columns' order and types. Indices that there are none of are kNone, which is -1 here.
struct Row {
  std::int32_t triangle;
  double t, u, v;
  std::int32_t side, tet, neighbor;
};

Row row_of(const tetfmt::Hit& hit) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  if (hit.outcome == tetfmt::Outcome::absent) return {-2, kNaN, 0, 0, -1, -1, -1};
  if (hit.outcome != tetfmt::Outcome::hit) return {-1, tetfmt::Hit{}.t, 0, 0, -1, -1, -1};
  return {static_cast<std::int32_t>(hit.triangle),
          hit.t,
          hit.u,
          hit.v,
          hit.back ? 1 : 0,
          static_cast<std::int32_t>(hit.tet),
          static_cast<std::int32_t>(hit.neighbor)};
}

template <class T>
void append_bytes(std::string& bytes, T value) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof value);  // little-endian, as tetfmt/layout.hpp asserts
  bytes.append(raw.data(), raw.size());
}

}  // namespace

HitFile::HitFile(const std::string& path, std::uint64_t count) : npy_(table_format(path, "--hits") == "npy") {
  if (path != "-") file_.emplace(path);
  write(npy_ ? npy_header(kDescr, count) : kCsvHeader);
}

std::string HitFile::format(std::span<const tetfmt::Hit> hits) const {
  std::string text;
  text.reserve(hits.size() * 40);
  for (const tetfmt::Hit& hit : hits) {
    const Row row = row_of(hit);
    const auto put = [&](auto value, char separator) {
      if (npy_) {
        append_bytes(text, value);
        return;
      }
      if constexpr (std::is_same_v<decltype(value), double>) {
        append_number(text, value);
      } else {
        append_number(text, static_cast<long long>(value));
      }
      text += separator;
    };
    put(row.triangle, ',');
    put(row.t, ',');
    put(row.u, ',');
    put(row.v, ',');
    put(row.side, ',');
    put(row.tet, ',');
    put(row.neighbor, '\n');
  }
  return text;
}

void HitFile::write(std::string_view formatted) {
  if (file_) {
    file_->write(formatted);
  } else {
    Output::standard().write(formatted);
  }
}

void HitFile::commit() {
  if (file_) file_->commit();
}

}  // namespace tetprep
