// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tet/ray_file.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <iterator>

#include <unistd.h>

#include "common/failure.hpp"
#include "common/output.hpp"
#include "common/parse.hpp"

namespace tetprep {
namespace {

constexpr std::array<const char*, 8> kColumns = {"ox", "oy", "oz", "dx", "dy", "dz", "t_min", "t_max"};
constexpr std::size_t kTMax = 7;
/// Without an interval, and with one.
constexpr std::array<std::size_t, 2> kColumnCounts = {6, 8};

bool allowed(std::size_t column, double value) {
  return std::isfinite(value) || (column == kTMax && value > 0);
}

GivenRay ray_of(std::span<const double> row) {
  GivenRay ray;
  for (std::size_t i = 0; i < 3; ++i) {
    ray.origin[i] = row[i];
    ray.direction[i] = row[i + 3];
  }
  if (row.size() == kColumns.size()) ray.interval = {row[kTMax - 1], row[kTMax]};
  return ray;
}

std::string read_standard_input() {
  std::string text;
  std::array<char, 1 << 16> piece;
  for (;;) {
    const ssize_t got = ::read(STDIN_FILENO, piece.data(), piece.size());
    if (got > 0) {
      text.append(piece.data(), static_cast<std::size_t>(got));
    } else if (got == 0) {
      return text;
    } else if (errno != EINTR) {
      throw Failure(ExitCode::io, std::string("standard input: cannot read: ") + std::strerror(errno));
    }
  }
}

/// A column's title. A field that a number begins, as in "0 0 1" or "0;0;1", is data in the wrong form, which
/// must not pass for a title; nor must "nan" and the like.
bool is_name(std::string_view field) {
  if (field.empty() || parse_double(field)) return false;
  const std::size_t first = field.find_first_not_of("+-.");
  return first != std::string_view::npos && std::isdigit(static_cast<unsigned char>(field[first])) == 0;
}

tetfmt::MappedFile map(const std::string& path) {
  auto file = tetfmt::MappedFile::open(path);
  if (file) return std::move(file).value();
  throw Failure(ExitCode::io, file.error().text + "; name a file of rays, or - for standard input");
}

}  // namespace

std::string table_format(const std::string& path, const char* option) {
  if (path == "-") return "csv";
  const auto dot = path.rfind('.');
  std::string ending = dot == std::string::npos ? "" : path.substr(dot + 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == "npy" || ending == "csv") return ending;
  throw Failure(ExitCode::usage,
                std::string(option) + " " + path + ": the name must end in .npy or .csv, or be -");
}

RayFile::RayFile(const std::string& path) : name_(path == "-" ? "standard input" : path) {
  const std::string format = table_format(path, "--rays");
  if (path == "-") {
    parse_csv(read_standard_input());
    return;
  }
  file_ = map(path);
  if (format == "npy") {
    matrix_.emplace(path, file_->bytes(), kColumnCounts);
    check_matrix();
  } else {
    parse_csv({reinterpret_cast<const char*>(file_->bytes().data()), file_->bytes().size()});
    file_.reset();
  }
}

GivenRay RayFile::operator[](std::size_t ray) const {
  if (!matrix_) return rows_[ray];
  std::array<double, kColumns.size()> row{};
  for (std::size_t i = 0; i < matrix_->columns(); ++i) row[i] = matrix_->at(ray, i);
  return ray_of(std::span(row).first(matrix_->columns()));
}

std::string RayFile::place(std::size_t ray) const {
  return matrix_ ? name_ + ": ray " + std::to_string(ray) : name_ + ":" + std::to_string(lines_[ray]);
}

void RayFile::check_matrix() const {
  for (std::size_t ray = 0; ray < matrix_->rows(); ++ray) {
    for (std::size_t i = 0; i < matrix_->columns(); ++i) {
      const double value = matrix_->at(ray, i);
      if (allowed(i, value)) continue;
      throw Failure(ExitCode::invalid, place(ray) + ": column " + std::to_string(i) + " (" + kColumns[i] +
                                           ") is " + number(value) + "; every number must be finite" +
                                           (i == kTMax ? ", or inf here" : ""));
    }
  }
}

void RayFile::parse_csv(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // the mark that some spreadsheets put first
  bool header_possible = true;
  std::size_t columns = 0, first_line = 0;  // how many there are, since which line
  for (std::size_t line = 1; !text.empty(); ++line) {
    const auto end = text.find('\n');
    const std::string_view row = trim(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (row.empty() || row[0] == '#') continue;

    const std::string where = name_ + ":" + std::to_string(line);
    std::array<double, kColumns.size()> values{};
    std::size_t column = 0, names = 0, bad_column = 0;
    std::string_view rest = row, bad_text;
    for (bool more = true; more; ++column) {
      const auto comma = rest.find(',');
      const std::string_view field = trim(rest.substr(0, comma));
      more = comma != std::string_view::npos;
      if (more) rest.remove_prefix(comma + 1);
      const auto value = parse_double(field);
      names += is_name(field);
      if (value && allowed(column, *value)) {
        if (column < values.size()) values[column] = *value;
      } else if (bad_column == 0) {
        bad_column = column + 1;
        bad_text = field;
      }
    }
    const bool possible =
        columns == 0 ? std::find(kColumnCounts.begin(), kColumnCounts.end(), column) != kColumnCounts.end()
                     : column == columns;
    if (!possible) {
      throw Failure(
          ExitCode::invalid,
          where + ": found " + std::to_string(column) + (column == 1 ? " column" : " columns") +
              ", expected " +
              (columns == 0 ? "6 separated by commas, ox,oy,oz,dx,dy,dz, or 8 with t_min,t_max"
                            : std::to_string(columns) + " as on line " + std::to_string(first_line)));
    }
    if (columns == 0) first_line = line;
    columns = column;
    if (std::exchange(header_possible, false) && names == column) continue;
    if (bad_column != 0) {
      throw Failure(ExitCode::invalid, where + ": column " + std::to_string(bad_column) + " (" +
                                           kColumns[bad_column - 1] + ") is '" +
                                           one_line(bad_text.substr(0, 40)) + "', expected a finite number" +
                                           (bad_column - 1 == kTMax ? " or inf" : ""));
    }
    rows_.push_back(ray_of(std::span(values).first(columns)));
    lines_.push_back(line);
  }
}

}  // namespace tetprep
