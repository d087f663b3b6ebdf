// SPDX-License-Identifier: AGPL-3.0-or-later
// The processes of a batch: fork, watch, reap. Each child runs convert() and leaves its report in memory that
// the parent reads when it has ended; what a child writes to disk is temporary until its conversion is done.
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "common/output.hpp"
#include "prep/batch.hpp"

namespace tetprep {
namespace {

using Clock = std::chrono::steady_clock;

/// The signals that end a batch, and SIGCHLD, wait to be asked for instead of striking. Those that are
/// ignored (nohup) stay so.
class HeldSignals {
 public:
  HeldSignals() {
    sigemptyset(&held_);
    sigaddset(&held_, SIGCHLD);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      struct sigaction action {};
      sigaction(signal, nullptr, &action);
      if (action.sa_handler != SIG_IGN) sigaddset(&held_, signal);
    }
    sigprocmask(SIG_BLOCK, &held_, &before_);
  }
  ~HeldSignals() { release(); }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;

  void release() const { sigprocmask(SIG_SETMASK, &before_, nullptr); }

  /// The next signal, 0 if none comes for a fifth of a second.
  int next() const {
    const timespec most{0, 200'000'000};
    return std::max(sigtimedwait(&held_, nullptr, &most), 0);
  }

 private:
  sigset_t held_{}, before_{};
};

[[noreturn]] void convert_and_exit(const ConvertOptions& options, int result) {
  ConvertReport report;
  std::optional<Failure> failure;
  try {
    Progress silent;
    convert(options, silent, report);
  } catch (const Failure& what) {
    failure = what;
  } catch (const std::exception& error) {
    failure.emplace(ExitCode::runtime, std::string("unexpected: ") + error.what());
  } catch (...) {
    failure.emplace(ExitCode::runtime, "unexpected failure of unknown kind");
  }
  try {
    Output(result, "the report").write(to_json(options, report, failure ? &*failure : nullptr));
  } catch (...) {
    _exit(static_cast<int>(ExitCode::runtime));
  }
  _exit(static_cast<int>(failure ? failure->code() : ExitCode::ok));
}

std::string contents_of(int descriptor) {
  std::string text;
  char part[4096];
  lseek(descriptor, 0, SEEK_SET);
  for (ssize_t size; (size = read(descriptor, part, sizeof part)) != 0;) {
    if (size > 0) {
      text.append(part, static_cast<std::size_t>(size));
    } else if (errno != EINTR) {
      break;
    }
  }
  return text;
}

/// One conversion that runs.
class Child {
 public:
  Child(std::size_t job, const ConvertOptions& options, const HeldSignals& signals)
      : job_(job), options_(options), result_(memfd_create("report", MFD_CLOEXEC)) {
    const pid_t parent = getpid();
    if (result_ >= 0) pid_ = fork();
    if (pid_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGTERM);  // the parent may be killed in ways that it cannot pass on
      if (getppid() != parent) _exit(1);
      signals.release();
      convert_and_exit(options_, result_);
    }
    if (pid_ < 0) {
      const int error = errno;
      if (result_ >= 0) close(result_);
      throw Failure(ExitCode::runtime,
                    std::string("cannot start a process for a conversion: ") + std::strerror(error));
    }
  }
  ~Child() {
    if (pid_ >= 0) {
      kill(pid_, SIGTERM);
      reap(0);
    }
    close(result_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  std::size_t job() const { return job_; }

  /// Asks it to end; the destructor waits for that.
  void stop() const { kill(pid_, SIGTERM); }

  bool ended() { return reap(WNOHANG); }

  /// Of one that has ended.
  JobResult result() const {
    JobResult result;
    result.report = contents_of(result_);
    nlohmann::json report = nlohmann::json::parse(result.report, nullptr, false);
    if (WIFEXITED(status_) && report.is_object()) {
      result.code = static_cast<ExitCode>(WEXITSTATUS(status_));
      result.outcome = report["outcome"];
      result.error = report.value("error", "");
      result.triangles = report["surface"]["input_triangles"];
      result.tets = report["result"]["tets"];
      result.seconds = report["seconds"];
      result.peak_memory_mb = report["peak_memory_mb"];
      return result;
    }
    const std::string how = WIFSIGNALED(status_) ? std::string("died of ") + strsignal(WTERMSIG(status_))
                                                 : "ended with code " + std::to_string(WEXITSTATUS(status_));
    const Failure failure(
        ExitCode::runtime,
        options_.inputs.front() + ": the conversion's process " + how +
            (WIFSIGNALED(status_) && WTERMSIG(status_) == SIGKILL ? ", perhaps for want of memory" : ""));
    ConvertReport known;
    known.seconds = result.seconds = std::chrono::duration<double>(Clock::now() - started_).count();
    known.peak_memory_mb = result.peak_memory_mb = static_cast<double>(usage_.ru_maxrss) * 1024e-6;
    result.report = to_json(options_, known, &failure);
    result.outcome = outcome(known, &failure);
    result.error = failure.what();
    return result;
  }

 private:
  bool reap(int flags) {
    pid_t ended = 0;
    do {
      ended = wait4(pid_, &status_, flags, &usage_);
    } while (ended < 0 && errno == EINTR);
    if (ended == 0) return false;
    pid_ = -1;
    return true;
  }

  std::size_t job_;
  ConvertOptions options_;
  int result_;
  pid_t pid_ = -1;
  int status_ = 0;
  rusage usage_{};
  Clock::time_point started_ = Clock::now();
};

}  // namespace

std::vector<JobResult> run_jobs(const std::vector<Job>& jobs, const ConvertOptions& common, unsigned at_once,
                                Progress& progress,
                                const std::function<void(const Job&, const JobResult&)>& finished) {
  ConvertOptions options = common;
  if (options.threads == 0)
    options.threads = std::max(1u, std::thread::hardware_concurrency() / std::max(at_once, 1u));
  options.report.clear();
  std::vector<JobResult> results(jobs.size());
  const HeldSignals signals;
  std::vector<std::unique_ptr<Child>> running;
  std::size_t next = 0, done = 0;
  progress.stage("convert " + std::to_string(jobs.size()) + (jobs.size() == 1 ? " scene" : " scenes"));
  while (done < jobs.size()) {
    while (running.size() < at_once && next < jobs.size()) {
      options.inputs = jobs[next].inputs;
      options.output = jobs[next].output;
      running.push_back(std::make_unique<Child>(next, options, signals));
      ++next;
    }
    progress.fraction(static_cast<double>(done) / static_cast<double>(jobs.size()));
    const int signal = signals.next();
    if (signal != 0 && signal != SIGCHLD) {
      for (const auto& child : running) child->stop();
      running.clear();
      signals.release();
      raise(signal);
      throw Failure(ExitCode::runtime, "interrupted");  // by a signal that does not end this process
    }
    // Several ends may have become one SIGCHLD.
    std::erase_if(running, [&](const auto& child) {
      if (!child->ended()) return false;
      results[child->job()] = child->result();
      finished(jobs[child->job()], results[child->job()]);
      ++done;
      return true;
    });
  }
  return results;
}

}  // namespace tetprep
