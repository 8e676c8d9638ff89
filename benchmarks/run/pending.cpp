// Record locks of POSIX: owned by the process, not by the open file.
#include "benchmarks/run/pending.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>

#include "core/clock.h"
#include "core/errors.h"
#include "core/files.h"

namespace isoline::benchmarks {
namespace {

bool lock(int descriptor, short kind, const std::string& cell) {
  struct flock one {};
  one.l_type = kind;
  one.l_whence = SEEK_SET;
  one.l_start = static_cast<off_t>(fnv1a(cell) >> 2);  // not negative, with space for the length
  one.l_len = 1;
  while (fcntl(descriptor, F_SETLK, &one) != 0) {
    if (errno == EACCES || errno == EAGAIN) return false;
    if (errno != EINTR) break;  // no locks here
  }
  return true;
}

// The locks within [begin, end), each a byte, counted by asking for one and then on either side.
std::size_t locks_between(int descriptor, off_t begin, off_t end) {
  if (begin >= end) return 0;
  struct flock one {};
  one.l_type = F_RDLCK;
  one.l_whence = SEEK_SET;
  one.l_start = begin;
  one.l_len = end - begin;
  if (fcntl(descriptor, F_GETLK, &one) != 0 || one.l_type == F_UNLCK) return 0;
  if (one.l_start < begin || one.l_start >= end) return 0;  // not one of our locks
  return 1 + locks_between(descriptor, begin, one.l_start) +
         locks_between(descriptor, one.l_start + 1, end);
}

}  // namespace

Holds::Holds(const std::filesystem::path& folder)
    : descriptor_(open((folder / "cells.lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
  require(descriptor_ >= 0, [&] {
    return fmt::format("cannot write in {}: {}", folder.string(), std::strerror(errno));
  });
}

Holds::~Holds() { close(descriptor_); }

bool Holds::take(const std::string& cell) { return lock(descriptor_, F_WRLCK, cell); }

void Holds::release(const std::string& cell) { lock(descriptor_, F_UNLCK, cell); }

std::size_t held_cells(const std::filesystem::path& folder) {
  const int descriptor = open((folder / "cells.lock").c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return 0;
  const std::size_t count = locks_between(descriptor, 0, std::numeric_limits<off_t>::max());
  close(descriptor);
  return count;
}

// The remaining cells of a plan, looked up in the store, and again while other runs work on it.

Pending::Pending(const std::vector<Request>& requests, Store& store, const RunOptions& options,
                 Outcome& outcome)
    : store_(store), options_(options), outcome_(outcome), holds_(store.folder()) {
  std::vector<std::pair<std::size_t, const Request*>> rounds;
  std::optional<RecordsOfAnyBuild> earlier;  // times of two builds make no list
  if (options.reuse && !options.force && options.repeat == 1) earlier.emplace(store.folder());
  for (const Request& request : requests) {
    if (earlier && is_reused(request, *earlier)) continue;
    const std::size_t wanted = runs_wanted(request);
    for (std::size_t i = 0; i < wanted; ++i) rounds.emplace_back(i, &request);
  }
  // Repetitions go round all cells, so that those of one cell see how the machine drifts.
  std::ranges::stable_sort(rounds, {}, [](const auto& entry) { return entry.first; });
  for (const auto& [round, request] : rounds) queue_.push_back(request);
}

// How often it is still to be run; one that is done is counted.
std::size_t Pending::runs_wanted(const Request& request) {
  std::optional<Record> done = store_.find(request);
  if (options_.redoes(done)) done.reset();
  const std::size_t have = done ? done->repeat_wall_seconds.size() : 0;
  const bool is_timed = !done || done->status != Status::inapplicable;
  const auto wanted = static_cast<std::size_t>(is_timed ? options_.repeat : 1);
  if (!done || (have < wanted && !is_failure(done->status))) return wanted - have;
  count_reused(*done);
  return 0;
}

bool Pending::is_reused(const Request& request, const RecordsOfAnyBuild& earlier) {
  if (store_.find(request)) return false;  // by this build
  const std::optional<Record> done = earlier.find(request);
  if (!done || options_.redoes(done)) return false;
  ++outcome_.reused_from_other_builds;
  count_reused(*done);
  return true;
}

void Pending::count_reused(const Record& done) {
  ++outcome_.reused;
  outcome_.count(done);
}

const Request* Pending::next() {
  constexpr std::int64_t kPatience = 200'000'000;  // nanoseconds between looks at what others hold
  if (monotonic_nanoseconds() < look_again_) return nullptr;
  for (std::size_t left = queue_.size(); left > 0; --left) {
    const Request& request = *queue_.front();
    queue_.pop_front();
    if (!holds_.take(store_.name_of(request))) {
      queue_.push_back(&request);
      continue;
    }
    if (options_.force || runs_wanted(request) > 0) return &request;
    release(request);  // it was done elsewhere meanwhile
  }
  if (!queue_.empty()) look_again_ = monotonic_nanoseconds() + kPatience;
  return nullptr;
}

void Pending::release(const Request& request) { holds_.release(store_.name_of(request)); }

}  // namespace isoline::benchmarks
