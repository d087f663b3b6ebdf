// SPDX-License-Identifier: AGPL-3.0-or-later
#include "differential/npy.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <regex>
#include <stdexcept>

namespace tetfmt_test {

namespace {

constexpr char kMagic[] = "\x93NUMPY\x01";  // with its final zero: magic, major 1, minor 0
static_assert(sizeof(kMagic) == 8);

template <class T>
double number_at(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof(value));
  return static_cast<double>(value);
}

}  // namespace

void write_rays(const std::string& path, std::span<const tetfmt::Ray> rays) {
  std::string header =
      "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(rays.size()) + ", 6), }";
  while ((10 + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::ofstream file(path, std::ios::binary);
  file.write(kMagic, 8);
  file.put(static_cast<char>(header.size() & 0xFF)).put(static_cast<char>(header.size() >> 8));
  file << header;
  static_assert(sizeof(tetfmt::Ray) == 24);
  file.write(reinterpret_cast<const char*>(rays.data()), static_cast<std::streamsize>(rays.size_bytes()));
  if (!file.flush()) throw std::runtime_error(path + ": cannot write");
}

NpyTable NpyTable::read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> all{std::istreambuf_iterator<char>(file), {}};
  const auto fail = [&](const char* what) -> void { throw std::runtime_error(path + ": " + what); };
  if (all.size() < 10 || !std::equal(kMagic, kMagic + 8, all.begin())) fail("not a .npy file of version 1.0");
  const std::size_t start =
      10 + static_cast<unsigned char>(all[8]) + 256 * static_cast<unsigned char>(all[9]);
  if (start % 64 != 0 || all.size() < start) fail("bad header length");
  const std::string header(all.begin() + 10, all.begin() + static_cast<std::ptrdiff_t>(start));

  NpyTable table;
  const std::regex field("\\('(\\w+)', '[<|]([fiu])([1248])'\\)");
  for (auto it = std::sregex_iterator(header.begin(), header.end(), field); it != std::sregex_iterator();
       ++it) {
    const auto width = static_cast<std::size_t>(std::stoi((*it)[3]));
    table.fields_.push_back({(*it)[1], (*it)[2].str()[0], width, table.stride_});
    table.stride_ += width;
  }
  std::smatch shape;
  if (!std::regex_search(header, shape, std::regex("'shape': \\((\\d+),\\)"))) fail("not one-dimensional");
  if (header.find("'fortran_order': False") == std::string::npos) fail("no 'fortran_order': False");
  table.size_ = std::stoull(shape[1]);
  if (table.fields_.empty() || all.size() != start + table.size_ * table.stride_) {
    fail("length and header disagree");
  }
  table.bytes_.assign(all.begin() + static_cast<std::ptrdiff_t>(start), all.end());
  return table;
}

std::vector<double> NpyTable::column(const std::string& name) const {
  const auto field =
      std::find_if(fields_.begin(), fields_.end(), [&](const Field& f) { return f.name == name; });
  if (field == fields_.end()) throw std::runtime_error("no field " + name);
  const auto read = [&]() -> double (*)(const char*) {
    switch (field->kind) {
      case 'f':
        return field->bytes == 8 ? number_at<double> : number_at<float>;
      case 'i':
        return field->bytes == 8   ? number_at<std::int64_t>
               : field->bytes == 4 ? number_at<std::int32_t>
               : field->bytes == 2 ? number_at<std::int16_t>
                                   : number_at<std::int8_t>;
      default:
        return field->bytes == 8   ? number_at<std::uint64_t>
               : field->bytes == 4 ? number_at<std::uint32_t>
               : field->bytes == 2 ? number_at<std::uint16_t>
                                   : number_at<std::uint8_t>;
    }
  }();
  std::vector<double> values(size_);
  for (std::size_t i = 0; i < size_; ++i) values[i] = read(bytes_.data() + i * stride_ + field->offset);
  return values;
}

}  // namespace tetfmt_test
