// Targets for readers of core: specs, records, arrays and what another program writes into its
// socket; and what all targets share.
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/errors.h"
#include "core/foreign/handshake.h"
#include "core/records/npy.h"
#include "core/records/record.h"
#include "core/spec.h"
#include "tests/fuzz/targets.h"

namespace isoline::fuzz {

namespace {

// Not what std::stoll and std::bad_alloc say, which is one word, nor what std::vector, std::string
// and the library of JSON say. A sentence may begin with any word that was read: "stoll: …".
bool is_a_sentence(const std::string& message) {
  for (const char* foreign :
       {"vector::_M_range_check: __n (which", "basic_string::", "[json.exception."})
    if (message.starts_with(foreign)) return false;
  return message.find(' ') != std::string::npos;
}

}  // namespace

void expect_read_or_refused(const std::function<void()>& read) {
  try {
    read();
  } catch (const UsageError& refusal) {
    if (!is_a_sentence(refusal.what()))
      throw std::logic_error("refused without a sentence: " + std::string(refusal.what()));
  }
}

MemoryFile::MemoryFile(std::string_view bytes)
    : descriptor_(memfd_create("isoline-fuzz", MFD_CLOEXEC)) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written <= 0) throw std::runtime_error("a file in memory cannot be written");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

MemoryFile::~MemoryFile() { ::close(descriptor_); }

std::string MemoryFile::path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

namespace {

constexpr std::uint64_t kMost = 1000;

// A value written as text comes back as it was.
void expect_round_trip(const std::string& value) {
  const Spec again = parse_spec("name[key=" + quoted(value) + "]");
  if (again.options.at(0).second != value) throw std::logic_error("a value came back changed");
}

}  // namespace

// Specs, seeds and durations.
void spec(std::string_view bytes) {
  expect_read_or_refused([&] {
    for (const SweepSize& size : sweep_sizes(bytes))
      if (size.settings == 0) throw std::logic_error("a sweep of nothing");
    for (const Spec& each : parse_specs(bytes, kMost)) {
      options_of(each);
      for (const auto& [key, value] : each.options) expect_round_trip(value);
    }
  });
  expect_read_or_refused([&] {
    const std::size_t count = parse_seeds(bytes, kMost).size();
    if (count == 0 || count > kMost) throw std::logic_error("seeds that were not asked for");
  });
  expect_read_or_refused([&] {
    const double seconds = parse_duration(bytes);
    if (!(seconds > 0 && std::isfinite(seconds))) throw std::logic_error("no time at all");
  });
}

// Records and plans: read, and written as they were read.
void record(std::string_view bytes) {
  const std::string text(bytes);
  expect_read_or_refused([&] {
    const std::string written = to_json(record_from_text(text, "the input")).dump();
    if (to_json(record_from_text(written, "its copy")).dump() != written)
      throw std::logic_error("a record came back changed");
  });
  expect_read_or_refused([&] { to_json(plan_from_text(text, "the input")).dump(); });
}

void npy(std::string_view bytes) {
  const MemoryFile file(bytes);
  expect_read_or_refused([&] {
    const NumberArray array = read_npy(file.path());
    Index count = 1;
    for (const Index each : array.shape) count *= each;
    if (count != static_cast<Index>(array.values.size()))
      throw std::logic_error("a shape that does not hold its numbers");
  });
}

namespace {

// A line whose other end has written so much and hung up.
std::unique_ptr<Line> line_after(std::string_view bytes) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw std::runtime_error("there is no socket");
  auto line = std::make_unique<Line>(ends[0]);
  const auto count = static_cast<std::size_t>(
      std::max(ssize_t{0}, ::send(ends[1], bytes.data(), bytes.size(), MSG_DONTWAIT)));
  ::close(ends[1]);
  if (count > bytes.size()) throw std::logic_error("more was written than there is");
  return line;
}

void expect_read_or_broken(const std::function<void()>& read) {
  expect_read_or_refused([&] {
    try {
      read();
    } catch (const LineError& error) {
      throw UsageError(error.what());
    }
  });
}

}  // namespace

void wire(std::string_view bytes) {
  const std::string text(bytes);
  expect_read_or_refused([&] { problem_handshake(text, "it"); });
  expect_read_or_refused([&] { method_handshake(text, "it"); });
  expect_read_or_broken([&] {
    const auto line = line_after(bytes);
    problem_handshake(line->receive_text(Verb::hello, kMostHandshake), line->sender());
    std::array<Real, 3> answer{};
    for (;;) line->receive_answer(Verb::linearize, answer);
  });
  expect_read_or_broken([&] {
    const auto line = line_after(bytes);
    std::array<Real, 5> room{};
    for (;;)
      if (line->receive(room).bytes > sizeof room) throw std::logic_error("beyond the room");
  });
}

}  // namespace isoline::fuzz

#ifdef ISOLINE_FUZZ_TARGET  // what libFuzzer calls with each input: the target that the build names
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  isoline::fuzz::ISOLINE_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  return 0;
}
#endif
