// Prints the progress line.
#include "benchmarks/run/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "core/clock.h"
#include "core/columns.h"
#include "core/text.h"

namespace isoline::benchmarks {

namespace {

double seconds_since(std::int64_t nanoseconds) {
  return 1e-9 * static_cast<double>(monotonic_nanoseconds() - nanoseconds);
}

// Besides these, the program emits no control sequences.
void clear_line() { std::fputs("\r\x1b[K", stderr); }
constexpr const char *kGreen = "\x1b[32m", *kUsualColour = "\x1b[0m";

// no-color.org: any text in NO_COLOR but the empty one switches colours off.
bool wants_colour() {
  const char* refusal = std::getenv("NO_COLOR");
  return refusal == nullptr || *refusal == 0;
}

}  // namespace

std::string duration_text(double seconds) {
  constexpr double kFew = 9.95;  // below, a tenth counts
  if (seconds < kFew) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  if (whole >= 3600) return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
  if (whole >= 60) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} s", whole);
}

std::string progress_bar(double part, std::size_t columns, bool has_colour) {
  const auto done =
      static_cast<std::size_t>(std::clamp(part, 0.0, 1.0) * static_cast<double>(columns));
  std::string text = has_colour ? kGreen : "";
  for (std::size_t i = 0; i < done; ++i) text += "█";
  if (has_colour) text += kUsualColour;
  for (std::size_t i = done; i < columns; ++i) text += "░";
  return text;
}

Progress::Style Progress::style_of(int descriptor) {
  const char* terminal = std::getenv("TERM");
  const bool is_dumb = terminal == nullptr || std::strcmp(terminal, "dumb") == 0;
  return isatty(descriptor) && !is_dumb ? Style::live : Style::plain;
}

Progress::Progress(Style style, std::string what, std::int64_t total, std::int64_t already)
    : style_(style),
      what_(std::move(what)),
      total_(total),
      already_(already),
      begun_(monotonic_nanoseconds()),
      shown_(begun_) {}

Progress::~Progress() {
  if (is_dirty_) clear_line();
}

std::string Progress::line() const {
  const std::int64_t done = already_ + done_;
  std::string text = total_ > 0 ? fmt::format("{} {}/{}", what_, done, total_) : what_;
  const double elapsed = seconds_since(begun_);
  if (done_ > 0 && elapsed > 0)
    text += fmt::format("  {:.3g}/s", static_cast<double>(done_) / elapsed);
  return current_.empty() ? text : text + "  " + current_;
}

void Progress::show(bool now) {
  const double pause = style_ == Style::live ? 0.1 : 10;  // seconds
  if (style_ == Style::silent || (!now && seconds_since(shown_) < pause)) return;
  shown_ = monotonic_nanoseconds();
  if (style_ == Style::live) {
    constexpr std::size_t kBar = 20, kLeastText = 40;  // columns
    std::size_t columns = terminal_width(STDERR_FILENO) - 1;
    clear_line();
    if (total_ > 0 && columns > kBar + kLeastText) {
      const double part = static_cast<double>(already_ + done_) / static_cast<double>(total_);
      std::fputs((progress_bar(part, kBar, wants_colour()) + " ").c_str(), stderr);  // not escaped
      columns -= kBar + 1;
    }
    say(stderr, cut(printable(line()), columns));
    std::fflush(stderr);
    is_dirty_ = true;
  } else {
    say(stderr, line() + "\n");
  }
}

}  // namespace isoline::benchmarks
