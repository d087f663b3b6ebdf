// SPDX-License-Identifier: AGPL-3.0-or-later
// Output files that are there in full or not at all.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace tetprep {

/// Writes a temporary beside the target and renames it over the target on commit(). Whatever ends the work
/// before that (an exception, SIGINT, SIGTERM, SIGHUP) removes the temporary and leaves an old target
/// untouched. A crash of the whole machine may still lose the new contents: nothing is synced.
///
/// A target that is a symbolic link is followed, and one that exists keeps its permission bits. One that
/// exists and is neither a file nor a directory
/// (/dev/null, /dev/full, a named pipe) cannot be replaced by a rename, so it is written to directly.
/// All members throw Failure (io) with path, reason and advice. Movable would mean a registered temporary
/// with two names, so it is not.
class AtomicFile {
 public:
  /// Fails at once if `target` is a directory, is write-protected, or lies where no file can be made: long
  /// work should not end in that discovery, so make the AtomicFile before the work.
  explicit AtomicFile(std::string target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::span<const std::byte> data);
  void write(std::string_view data) { write(std::as_bytes(std::span(data))); }

  /// Replaces bytes that were written before. Fails where the target is a pipe or the like.
  void overwrite(std::size_t offset, std::string_view data);

  /// Where the bytes are before commit(): to read them back and check them.
  const std::string& temporary() const { return temporary_; }

  /// Closes and renames. Nothing may be written afterwards.
  void commit();

 private:
  void discard() noexcept;
  [[noreturn]] void fail(const std::string& doing, int error) const;

  std::string target_;     ///< as the user named it
  std::string resolved_;   ///< symbolic links followed
  std::string temporary_;  ///< resolved_ itself if that is a device
  int descriptor_ = -1;
  int slot_ = -1;  ///< in the table that the signal handler reads; -1 for a device
};

}  // namespace tetprep
