// Files of evaluations. Each begins with a line for readers; then entries follow, each with a
// marker, its lengths and checksums. What is damaged costs the damaged entries alone: reading
// continues at the next marker. Entries are only appended, each by one write. A file has one
// writer, which holds its lock.
#include "core/foreign/evaluations.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "core/clock.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/foreign/foreign.h"
#include "core/shell.h"

namespace isoline {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kHeading = "isoline.calls/4 ";
constexpr std::array<char, 8> kMarker = {'\x93', 'c', 'a', 'l', 'l', '\r', '\n', '\x1a'};

// Closes with its scope.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  int get() const { return number_; }

 private:
  int number_;
};

// A regular file of the folder, never what a link in it names; −1 where it is anything else.
Descriptor opened(const fs::path& folder, const std::string& name, int flags) {
  const Descriptor place(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
  if (place.get() < 0) return Descriptor();
  constexpr mode_t kMode = 0666;
  Descriptor file(
      openat(place.get(), name.c_str(), flags | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, kMode));
  struct stat about {};
  const bool is_regular =
      file.get() >= 0 && fstat(file.get(), &about) == 0 && S_ISREG(about.st_mode);
  return is_regular ? std::move(file) : Descriptor();
}

std::int64_t size_of(int file) {
  struct stat about {};
  return fstat(file, &about) == 0 ? about.st_size : 0;
}

bool read_at(int file, void* to, std::size_t count, std::int64_t at) {
  char* bytes = static_cast<char*>(to);
  while (count > 0) {
    const ssize_t got = pread(file, bytes, count, at);
    if (got <= 0) return false;
    bytes += got;
    at += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

std::string bytes_of(Evaluations::Numbers request) {
  std::string bytes;
  for (const std::span<const Real> part : request)
    if (!part.empty()) bytes.append(reinterpret_cast<const char*>(part.data()), part.size_bytes());
  return bytes;
}

std::uint64_t place_of(Verb verb, std::string_view request) {
  return fnv1a(request, kDigestStart ^ static_cast<std::uint64_t>(verb));
}

// From `at` on; the end where no marker follows. A marker may lie across two pieces.
std::int64_t next_marker(int file, std::int64_t at, std::int64_t end) {
  std::vector<char> piece(std::size_t{1} << 16);
  while (at + std::ssize(kMarker) <= end) {
    const auto count = std::min<std::int64_t>(end - at, std::ssize(piece));
    if (!read_at(file, piece.data(), static_cast<std::size_t>(count), at)) return end;
    const auto found =
        std::search(piece.begin(), piece.begin() + count, kMarker.begin(), kMarker.end());
    if (found != piece.begin() + count) return at + (found - piece.begin());
    at += count - std::ssize(kMarker) + 1;
  }
  return end;
}

}  // namespace

EvaluationKey::EvaluationKey(std::string started, const OptionValues& declared,
                             std::uint64_t instance)
    : seed(instance), command(std::move(started)) {
  std::string all = command + "\n" + digest_of_files(shell_words(command)) + "\n";
  for (const NamedOption& option : declared)
    all += option.name + "=" + option_text(option.value) + "\n";
  problem = digest(all);
}

std::string EvaluationKey::stem() const { return fmt::format("{}.{}", problem, seed); }

struct Evaluations::Head {
  std::array<char, 8> marker = kMarker;
  std::uint32_t verb = 0, is_late = 0;
  std::uint64_t request = 0, answer = 0, why = 0;  // bytes of each, which follow
  double seconds = 0;
  std::uint64_t sum_of_bytes = 0, sum = 0;  // of the bytes; of all before it

  std::uint64_t computed_sum(std::string_view stem) const {
    return fnv1a({reinterpret_cast<const char*>(this), offsetof(Head, sum)}, fnv1a(stem));
  }
  std::uint64_t size() const { return request + answer + why; }
  // Each alone, since a hostile file's may wrap in their sum.
  bool is_within(std::uint64_t most) const {
    return request <= most && answer <= most && why <= most && size() <= most;
  }
};

// A file of one problem and seed, as far as it was read.
struct Evaluations::File {
  Descriptor descriptor;
  std::int64_t read = 0;  // bytes
};

struct Evaluations::Stored {
  std::string stem;
  std::map<std::string, File> files;  // by name
  struct Place {
    int descriptor;
    std::int64_t at;
  };
  std::unordered_map<std::uint64_t, Place> places;  // of entries, the last of each request
  Descriptor writer;
  std::string writer_name;
  bool was_slow = true;     // the last call: then others may have written meanwhile
  std::int64_t synced = 0;  // monotonic nanoseconds

  bool read_entry(int file, std::int64_t at, Head& head, std::string& bytes) const {
    const std::int64_t left = size_of(file) - at - static_cast<std::int64_t>(sizeof head);
    if (left < 0 || !read_at(file, &head, sizeof head, at) || head.marker != kMarker ||
        head.computed_sum(stem) != head.sum || !head.is_within(static_cast<std::uint64_t>(left)))
      return false;
    bytes.resize(head.size());
    return read_at(file, bytes.data(), bytes.size(), at + static_cast<std::int64_t>(sizeof head)) &&
           fnv1a(bytes) == head.sum_of_bytes;
  }
};

void Evaluations::begin(Settings settings) {
  settings_ = std::move(settings);
  if (!settings_.folder.empty()) settings_.folder /= "evaluations";
  stored_.clear();
  recent_.clear();
  recent_numbers_ = 0;
  answered_seconds_ = 0;
}

const Evaluations::Recent* Evaluations::recent(const EvaluationKey& key, Verb verb,
                                               std::string_view request) const {
  if (verb != Verb::linearize) return nullptr;
  const std::uint64_t place = place_of(verb, request);
  for (const Recent& call : recent_)
    if (call.place == place && call.request == request && call.stem == key.stem()) return &call;
  return nullptr;
}

void Evaluations::remember(Recent call) {
  constexpr std::size_t kMost = 64, kMostNumbers = std::size_t{1} << 20;
  recent_numbers_ += call.answer.size();
  recent_.push_front(std::move(call));
  while (recent_.size() > kMost || (recent_numbers_ > kMostNumbers && recent_.size() > 1)) {
    recent_numbers_ -= recent_.back().answer.size();
    recent_.pop_back();
  }
}

Evaluations::Stored& Evaluations::stored(const EvaluationKey& key) {
  std::shared_ptr<Stored>& of = stored_[key.stem()];
  if (!of) {
    of = std::make_shared<Stored>();
    of->stem = key.stem();
  }
  if (std::exchange(of->was_slow, false)) read_on(*of, settings_.folder);
  return *of;
}

// An entry at the end of a file that is not whole may be just written.
void Evaluations::read_on(Stored& of, const fs::path& folder) {
  for (const fs::path& path : evaluation_files(folder.parent_path(), of.stem)) {
    const std::string name = path.filename().string();
    File& file = of.files[name];
    if (file.descriptor.get() < 0) file.descriptor = opened(folder, name, O_RDONLY);
    const int number = file.descriptor.get();
    if (number < 0) continue;
    const std::int64_t end = size_of(number);
    Head head;
    std::string bytes;
    bool is_damaged = false;
    while (file.read < end) {
      if (of.read_entry(number, file.read, head, bytes)) {
        const std::string_view request(bytes.data(), head.request);
        of.places[place_of(static_cast<Verb>(head.verb), request)] = {number, file.read};
        file.read += static_cast<std::int64_t>(sizeof head + bytes.size());
        continue;
      }
      const bool is_heading = file.read == 0;
      const std::int64_t next = next_marker(number, file.read + 1, end);
      if (next == end) break;
      is_damaged = is_damaged || !is_heading;
      file.read = next;
    }
    if (is_damaged)
      remark_on_calls(fmt::format("{} is damaged: the calls at the damaged places are made again",
                                  path.string()));
  }
}

std::optional<std::string> Evaluations::find(const EvaluationKey& key, Verb verb, Numbers request,
                                             std::span<Real> answer, double most_seconds) {
  const std::string asked = bytes_of(request);
  if (const Recent* const call = recent(key, verb, asked)) {
    std::ranges::copy(call->answer, answer.begin());
    return call->why;
  }
  if (settings_.folder.empty() || !settings_.answers) return std::nullopt;
  Stored& of = stored(key);
  if (of.places.empty()) return std::nullopt;
  const auto place = of.places.find(place_of(verb, asked));
  Head head;
  std::string bytes;
  if (place == of.places.end() ||
      !of.read_entry(place->second.descriptor, place->second.at, head, bytes) ||
      head.verb != static_cast<std::uint32_t>(verb) || bytes.substr(0, head.request) != asked)
    return std::nullopt;
  const bool has_failed = head.why > 0;
  if (!has_failed && head.answer != answer.size_bytes()) return std::nullopt;
  if (has_failed &&
      (!settings_.answers_failures || (head.is_late != 0 && head.seconds < most_seconds)))
    return std::nullopt;
  if (!has_failed && head.answer > 0)
    std::memcpy(answer.data(), bytes.data() + head.request, head.answer);
  answered_seconds_ += head.seconds;
  ++call_report().answered;
  return bytes.substr(head.request + head.answer);
}

bool Evaluations::has(const EvaluationKey& key, Verb verb, Numbers request) {
  const std::string asked = bytes_of(request);
  return recent(key, verb, asked) != nullptr ||
         (!settings_.folder.empty() && settings_.answers &&
          stored(key).places.contains(place_of(verb, asked)));
}

// The first file of the problem that no other process writes.
bool Evaluations::open_for_writing(Stored& of, const EvaluationKey& key) {
  if (of.writer.get() >= 0) return true;
  std::error_code error;
  fs::create_directories(settings_.folder, error);
  constexpr int kMostWriters = 4096;
  for (int i = 0; i < kMostWriters; ++i) {
    of.writer_name = fmt::format("{}.{}.calls", of.stem, i);
    Descriptor file = opened(settings_.folder, of.writer_name, O_RDWR | O_CREAT | O_APPEND);
    if (file.get() < 0) {
      if (is_there(settings_.folder / of.writer_name)) continue;  // a link, for example
      break;
    }
    if (flock(file.get(), LOCK_EX | LOCK_NB) != 0) continue;
    if (size_of(file.get()) == 0) {
      std::string command = key.command.substr(0, key.command.find('\n'));
      const std::string heading = fmt::format("{}of seed {} of: {}\n", kHeading, key.seed, command);
      if (write(file.get(), heading.data(), heading.size()) != std::ssize(heading)) break;
    }
    std::string begin(kHeading.size(), '\0');
    if (!read_at(file.get(), begin.data(), begin.size(), 0) || begin != kHeading) continue;
    of.writer = std::move(file);
    return true;
  }
  remark_on_calls(
      fmt::format("{} cannot be written ({}): finished calls are not kept, and are lost with a run "
                  "that is killed",
                  (settings_.folder / of.writer_name).string(), std::strerror(errno)));
  return false;
}

void Evaluations::keep(const EvaluationKey& key, Verb verb, Numbers request,
                       std::span<const Real> answer, const std::string& why, double seconds,
                       bool is_late, bool is_remembered) {
  if (verb == Verb::linearize && !is_late && is_remembered) {
    const std::string asked = bytes_of(request);
    std::vector<Real> numbers;
    if (why.empty()) numbers.assign(answer.begin(), answer.end());
    remember({place_of(verb, asked), key.stem(), asked, why, std::move(numbers)});
  }
  if (settings_.folder.empty() || (seconds < kSlowSeconds && !settings_.keeps_all)) return;
  Stored& of = stored(key);
  if (seconds >= kSlowSeconds) of.was_slow = true;
  if (!open_for_writing(of, key)) return;
  Head head{
      .verb = static_cast<std::uint32_t>(verb), .is_late = is_late ? 1U : 0U, .seconds = seconds};
  std::string bytes = bytes_of(request);
  head.request = bytes.size();
  if (why.empty() && !answer.empty()) {
    head.answer = answer.size_bytes();
    bytes.append(reinterpret_cast<const char*>(answer.data()), head.answer);
  }
  bytes += why;
  head.why = why.size();
  head.sum_of_bytes = fnv1a(bytes);
  head.sum = head.computed_sum(of.stem);
  const std::string entry = std::string(reinterpret_cast<const char*>(&head), sizeof head) + bytes;
  const ssize_t written = write(of.writer.get(), entry.data(), entry.size());
  if (written != std::ssize(entry))
    remark_on_calls(fmt::format(
        "{} cannot be written ({}): finished calls are not kept, and are lost with a run that is "
        "killed",
        (settings_.folder / of.writer_name).string(), std::strerror(written < 0 ? errno : ENOSPC)));
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t now = monotonic_nanoseconds();
  if (now - of.synced < kSecond) return;
  of.synced = now;
  fdatasync(of.writer.get());
}

std::vector<fs::path> evaluation_files(const fs::path& folder, std::string_view stem) {
  std::vector<fs::path> files;
  const fs::path all = folder / "evaluations";
  if (std::error_code error; !fs::is_directory(fs::symlink_status(all, error))) return files;
  for (const std::string& name : names_in(all))
    if (name.starts_with(fmt::format("{}.", stem)) && name.ends_with(".calls"))
      files.push_back(all / name);
  return files;
}

double call_clock() {
  return 1e-9 * static_cast<double>(monotonic_nanoseconds()) + evaluations().answered_seconds();
}

}  // namespace isoline
