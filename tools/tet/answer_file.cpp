// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tet/answer_file.hpp"

#include <limits>

#include "common/npy.hpp"
#include "common/output.hpp"
#include "tet/ray_file.hpp"

namespace tetprep {

AnswerFile::AnswerFile(const std::string& path, std::span<const Column> columns,
                       std::optional<std::uint64_t> count)
    : binary_(table_format(path, "--hits") == "npy"), counted_(count.has_value()) {
  std::string names;
  for (const Column& column : columns) {
    descr_ += (descr_.empty() ? "[('" : ", ('") + std::string(column.name) + "', '" + column.type + "')";
    names += (names.empty() ? "" : ",") + std::string(column.name);
  }
  descr_ += "]";
  if (path != "-") file_.emplace(path);
  if (!binary_) {
    write(names + "\n");
    return;
  }
  // The longest number that there is leaves room for the right one.
  const std::string header = npy_header(descr_, count.value_or(std::numeric_limits<std::uint64_t>::max()));
  header_size_ = header.size();
  write(header);
  if (!counted_) file_->overwrite(0, header);  // a target that cannot do this is told before the work
}

void AnswerFile::write(const Rows& rows) {
  write(rows.bytes());
  count_ += rows.count();
}

void AnswerFile::write(std::string_view bytes) {
  if (file_) {
    file_->write(bytes);
  } else {
    Output::standard().write(bytes);
  }
}

void AnswerFile::commit() {
  if (!file_) return;
  if (binary_ && !counted_) file_->overwrite(0, npy_header(descr_, count_, header_size_));
  file_->commit();
}

}  // namespace tetprep
