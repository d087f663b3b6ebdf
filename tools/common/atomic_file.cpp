// SPDX-License-Identifier: AGPL-3.0-or-later
#include "common/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <utility>

#include "common/failure.hpp"

namespace tetprep {
namespace {

// Temporaries to remove on a signal. The handler may run at any instruction of any thread, so the table is
// static storage that is never freed, and a slot is read only while `owner` is a process id. A forked child
// inherits table and handler, but not the duty: its id differs.
struct Slot {
  std::atomic<bool> taken{false};
  std::atomic<pid_t> owner{0};
  std::array<char, 4096> path{};
};
std::array<Slot, 16> g_slots;
static_assert(std::atomic<pid_t>::is_always_lock_free);

void remove_temporaries_and_die(int signal) {
  for (Slot& slot : g_slots) {
    if (slot.owner.load() == getpid()) unlink(slot.path.data());
  }
  // Only now: a second signal, while the first is at work, must not end the process before that is done.
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  sigaction(signal, &usual, nullptr);
  raise(signal);
}

void install_handlers() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction old {};
    sigaction(signal, nullptr, &old);
    if (old.sa_handler != SIG_DFL) continue;  // ignored (nohup), or somebody else's
    struct sigaction action {};
    action.sa_handler = remove_temporaries_and_die;
    sigaction(signal, &action, nullptr);
  }
}

/// Takes a slot before the file exists, so that no moment is uncovered. -1 if all are taken or `path` is too
/// long: then a signal leaves the temporary behind, which is no reason to refuse the work.
int register_temporary(const std::string& path) {
  static const bool installed = (install_handlers(), true);
  (void)installed;
  if (path.size() >= g_slots[0].path.size()) return -1;
  for (std::size_t i = 0; i < g_slots.size(); ++i) {
    if (g_slots[i].taken.exchange(true)) continue;
    std::memcpy(g_slots[i].path.data(), path.c_str(), path.size() + 1);
    g_slots[i].owner.store(getpid());
    return static_cast<int>(i);
  }
  return -1;
}

void release(int slot) {
  if (slot < 0) return;
  g_slots[static_cast<std::size_t>(slot)].owner.store(0);
  g_slots[static_cast<std::size_t>(slot)].taken.store(false);
}

std::string temporary_beside(const std::string& path) {
  static std::atomic<unsigned> serial{0};
  const auto folder = std::filesystem::path(path).parent_path();
  return (folder / (".tet-" + std::to_string(getpid()) + "-" + std::to_string(serial++) + ".tmp")).string();
}

}  // namespace

AtomicFile::AtomicFile(std::string target) : target_(std::move(target)), resolved_(target_) {
  struct stat status {};
  const bool exists = stat(resolved_.c_str(), &status) == 0;
  std::error_code error;
  // What is no file is opened by the name that it has: a pipe behind /dev/stdout has no other.
  if (std::filesystem::is_symlink(target_, error) && (!exists || S_ISREG(status.st_mode))) {
    const auto followed = std::filesystem::canonical(target_, error);
    if (error) fail("follow the link", error.value());  // dangling or circular
    resolved_ = followed.string();
  }
  if (exists) {
    if (S_ISDIR(status.st_mode)) fail("write", EISDIR);
    if (access(resolved_.c_str(), W_OK) != 0) fail("write", errno);
    if (!S_ISREG(status.st_mode)) {
      temporary_ = resolved_;
      descriptor_ = open(resolved_.c_str(), O_WRONLY | O_CLOEXEC);
      if (descriptor_ < 0) fail("open", errno);
      return;
    }
  }
  if (resolved_.empty() || resolved_.back() == '/') fail("write", EISDIR);
  do {
    release(slot_);
    temporary_ = temporary_beside(resolved_);
    slot_ = register_temporary(temporary_);
    // O_EXCL: never write through something that another process put there. 0666 leaves the mode to the
    // umask.
    descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (descriptor_ < 0 && errno == EEXIST);
  if (descriptor_ < 0) {
    const int reason = errno;
    release(slot_);
    fail("create a file there", reason);
  }
  // A file that is replaced keeps who may do what with it. A file system without permissions may refuse.
  if (exists && fchmod(descriptor_, status.st_mode & 0777) != 0) errno = 0;
}

AtomicFile::~AtomicFile() {
  discard();
}

void AtomicFile::write(std::span<const std::byte> data) {
  while (!data.empty()) {
    const ssize_t written = ::write(descriptor_, data.data(), data.size());
    if (written >= 0) {
      data = data.subspan(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      fail("write", errno);
    }
  }
}

void AtomicFile::overwrite(std::size_t offset, std::string_view data) {
  while (!data.empty()) {
    const ssize_t written = ::pwrite(descriptor_, data.data(), data.size(), static_cast<off_t>(offset));
    if (written >= 0) {
      offset += static_cast<std::size_t>(written);
      data.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      fail("go back to write the beginning", errno);
    }
  }
}

void AtomicFile::commit() {
  const int descriptor = std::exchange(descriptor_, -1);
  if (close(descriptor) != 0) {  // network file systems report a full disk only here
    const int reason = errno;
    descriptor_ = -1;
    if (temporary_ != resolved_) unlink(temporary_.c_str());
    fail("write", reason);
  }
  if (temporary_ == resolved_) return;
  if (rename(temporary_.c_str(), resolved_.c_str()) != 0) {
    const int reason = errno;
    unlink(temporary_.c_str());
    fail("rename the finished file", reason);
  }
  release(std::exchange(slot_, -1));
}

void AtomicFile::discard() noexcept {
  if (descriptor_ >= 0) {
    close(std::exchange(descriptor_, -1));
    if (temporary_ != resolved_) unlink(temporary_.c_str());
  }
  release(std::exchange(slot_, -1));
}

void AtomicFile::fail(const std::string& doing, int error) const {
  const char* advice = "";
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      advice = "; free some space or write elsewhere";
      break;
    case EACCES:
    case EPERM:
    case EROFS:
      advice = "; choose a place where you may write";
      break;
    case EISDIR:
      advice = "; name a file";
      break;
    case ENOENT:
      advice = "; create the folder first";
      break;
    case ESPIPE:
      advice = "; name a file, or a format that is written from front to back";
      break;
    default:
      break;
  }
  throw Failure(ExitCode::io, target_ + ": cannot " + doing + ": " + std::strerror(error) + advice);
}

}  // namespace tetprep
