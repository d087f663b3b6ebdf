// SPDX-License-Identifier: AGPL-3.0-or-later
// The parent's side: fork, watch, reap. What runs in the child is tetgen_stages.cpp.
#include "prep/tetgen_child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>

#include "prep/tetgen_stages.hpp"

namespace tetprep {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void fail(const char* doing) {
  throw Failure(ExitCode::runtime, std::string("cannot ") + doing + ": " + std::strerror(errno));
}

/// How long a stage takes, in units of the stage "delaunay", on closed surfaces of 350,000 triangles.
double usual_share(const std::string& stage) {
  static constexpr std::pair<const char*, double> kShares[] = {{"delaunay", 1},
                                                               {"surface", 0.12},
                                                               {"boundary recovery", 1.1},
                                                               {"exterior", 0.02},
                                                               {"steiner suppression", 0.1},
                                                               {"delaunay recovery", 0.34},
                                                               {"refinement", 0.43},
                                                               {"optimization", 0.23},
                                                               {"hand over", 0.12}};
  for (const auto& [name, share] : kShares)
    if (stage == name) return share;
  return 0;
}

/// The share of a stage that is done, by a guess how long it takes: no more than that, but it never goes back
/// and never claims the end. Past nine tenths of the guess it slows down.
double guess_done(double spent, double expected) {
  if (expected <= 0) return 0;
  const double share = spent / expected;
  constexpr double kTrusted = 0.9;
  if (share < kTrusted) return share;
  return 1 - (1 - kTrusted) * std::exp((kTrusted - share) / (1 - kTrusted) / 10);
}

/// In the child, before TetGen.
void leave_parent_behind(pid_t parent) {
  // Dies with the parent, however that ends. If the parent is gone already, no signal will come.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGABRT, SIGSEGV}) ::signal(signal, SIG_DFL);
  // TetGen prints, even with -Q, on its way out.
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int descriptor : {0, 1, 2}) dup2(nowhere, descriptor);
  prctl(PR_SET_DUMPABLE, 0);  // a crash here is an answer, and needs no core file
}

/// In the child: allocations beyond `bytes` more than it has now fail. Of the address space, since that is
/// what the kernel limits; TetGen uses nearly all that it asks for.
void limit_memory(std::uint64_t bytes) {
  if (bytes == 0) return;
  std::uint64_t pages = 0;
  if (FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%" SCNu64, &pages) != 1) pages = 0;
    std::fclose(file);
  }
  const auto had = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  const rlimit limit{had + bytes, had + bytes};
  setrlimit(RLIMIT_AS, &limit);
}

}  // namespace

TetgenMesh::TetgenMesh(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) == 0) bytes_ = static_cast<std::size_t>(status.st_size);
  memory_ = bytes_ == 0 ? MAP_FAILED : mmap(nullptr, bytes_, PROT_READ, MAP_SHARED, descriptor, 0);
  const int error = errno;
  close(descriptor);
  errno = error;
  if (memory_ == MAP_FAILED) fail("map TetGen's result");
  const auto* at = static_cast<const std::byte*>(memory_);
  const auto& sizes = *reinterpret_cast<const TetgenSizes*>(at);
  at += sizeof sizes;
  const auto take = [&]<class T>(std::span<const T>& array, std::uint64_t count) {
    array = {reinterpret_cast<const T*>(at), static_cast<std::size_t>(count)};
    at += array.size_bytes();
  };
  take(points, sizes.points);
  take(tets, sizes.tets);
  take(neighbors, sizes.tets);
  take(facets, sizes.tets);
}

TetgenMesh::~TetgenMesh() {
  munmap(memory_, bytes_);
}

TetgenChild::TetgenChild(std::span<const GridPoint> points, std::span<const std::array<Index, 3>> facets,
                         const TetgenCall& call)
    : points_(points.size()), memory_limit_(call.most_memory) {
  int pipe_ends[2];
  if (pipe2(pipe_ends, O_CLOEXEC) != 0) fail("make a pipe");
  messages_ = pipe_ends[0];
  result_ = memfd_create("tetgen", MFD_CLOEXEC);
  const pid_t parent = getpid();
  if (result_ >= 0) pid_ = fork();
  if (pid_ == 0) {
    leave_parent_behind(parent);
    limit_memory(call.most_memory);
    run_tetgen(points, facets, call, pipe_ends[1], result_);
    _exit(0);
  }
  const int error = errno;
  close(pipe_ends[1]);
  if (pid_ < 0) {
    close(messages_);
    if (result_ >= 0) close(result_);
    errno = error;
    fail("start a process for TetGen");
  }
}

TetgenChild::~TetgenChild() {
  kill_and_reap();
  close(messages_);
  if (result_ >= 0) close(result_);
}

void TetgenChild::kill_and_reap() {
  if (pid_ < 0) return;
  kill(pid_, SIGKILL);
  while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
}

TetgenChild::Outcome TetgenChild::wait(double seconds, Progress& progress,
                                       const std::function<bool()>& give_up) {
  const auto deadline = Clock::now() + std::chrono::duration<double>(seconds);
  Outcome outcome;
  std::string stage = "start";
  double stage_started = 0;
  // Until it has been seen, 7 microseconds a point: 350,000 triangles take 1.5 s on one of today's cores.
  double delaunay_seconds = 7e-6 * static_cast<double>(points_);
  auto stage_seen = Clock::now();
  bool done = false;
  std::string failure;

  const auto receive = [&](const TetgenMessage& message) {
    if (message.kind == TetgenMessage::Kind::stuck) {
      outcome.stuck.assign(message.facets.begin(), message.facets.begin() + message.facet_count);
      return;
    }
    if (message.kind != TetgenMessage::Kind::failed && stage != "start")
      outcome.stages.push_back({"tetgen: " + stage, message.seconds - stage_started, message.peak_memory_mb});
    if (stage == "delaunay") delaunay_seconds = message.seconds - stage_started;
    if (message.kind == TetgenMessage::Kind::stage) {
      stage_seen = Clock::now();
      outcome.stage = stage = message.text;
      stage_started = message.seconds;
      progress.stage("tetgen: " + stage);
    } else if (message.kind == TetgenMessage::Kind::failed) {
      failure = message.text;
    } else {
      done = true;
    }
  };
  const auto stop = [&](std::string reason) {
    kill_and_reap();
    outcome.reason = std::move(reason);
    return std::move(outcome);
  };

  for (;;) {
    if (give_up()) return stop("");
    if (Clock::now() >= deadline)
      return stop("no end after " + std::to_string(static_cast<long>(seconds)) + " s, in stage \"" + stage +
                  "\"");
    const std::chrono::duration<double> spent = Clock::now() - stage_seen;
    if (const double share = usual_share(stage); share > 0)
      progress.fraction(guess_done(spent.count(), share * delaunay_seconds));
    pollfd waiting{messages_, POLLIN, 0};
    constexpr int kMilliseconds = 20;
    if (poll(&waiting, 1, kMilliseconds) <= 0) continue;
    TetgenMessage message;
    const ssize_t size = read(messages_, &message, sizeof message);
    if (size < 0 && errno == EINTR) continue;
    if (size != static_cast<ssize_t>(sizeof message)) break;  // the child has closed its end: it is gone
    receive(message);
  }

  int status = 0;
  rusage used{};
  while (wait4(pid_, &status, 0, &used) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  const std::string in_stage = " in stage \"" + stage + "\"";
  // Where TetGen does not check an allocation, its failure looks like any other crash.
  const bool near_limit = memory_limit_ > 0 && WIFSIGNALED(status) &&
                          static_cast<std::uint64_t>(used.ru_maxrss) * 1024 > memory_limit_ / 10 * 9;
  if (done) {
    outcome.mesh = std::make_unique<TetgenMesh>(std::exchange(result_, -1));
  } else if (failure == kOutOfMemory || near_limit) {
    outcome.reason = memory_limit_ > 0 ? "needs more than " + std::to_string(memory_limit_ / 1'000'000) +
                                             " MB of memory," + in_stage
                                       : kOutOfMemory + ("," + in_stage);
  } else if (!failure.empty()) {
    outcome.reason = failure + "," + in_stage;
  } else if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) {
    outcome.reason = "was killed from outside, most likely for want of memory," + in_stage;
  } else {
    const std::string how = WIFSIGNALED(status) ? std::string("died of ") + strsignal(WTERMSIG(status))
                                                : "ended with code " + std::to_string(WEXITSTATUS(status));
    outcome.reason = how + in_stage;
  }
  return outcome;
}

}  // namespace tetprep
