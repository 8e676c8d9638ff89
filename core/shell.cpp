// Quotes words with single quotes, within which a shell reads every letter except one as itself,
// and reads quoted words.
#include "core/shell.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <ctime>
#include <mutex>
#include <vector>

#include "core/errors.h"

namespace isoline {
namespace {

bool is_literal(char letter) {
  constexpr std::string_view kSafe = "%+,-./:=@_";
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
         (letter >= '0' && letter <= '9') || kSafe.find(letter) != std::string_view::npos;
}

// Reads words letter by letter.
class WordReader {
 public:
  explicit WordReader(std::string_view command) : rest_(command) {}

  // Whether there was another.
  bool read(std::string& word) {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kSpace), rest_.size()));
    word.clear();
    const bool is_there = !rest_.empty();
    while (!rest_.empty() && kSpace.find(rest_.front()) == std::string_view::npos)
      if (const char letter = take(); letter == '\'')
        read_single(word);
      else if (letter == '"')
        read_double(word);
      else if (letter == '\\')
        word += take();
      else
        word += letter;
    return is_there;
  }

 private:
  static constexpr std::string_view kSpace = " \t\r\n";

  char take() {
    require(!rest_.empty(), "a command must not end inside a quote or after a backslash");
    const char letter = rest_.front();
    rest_.remove_prefix(1);
    return letter;
  }
  void read_single(std::string& word) {
    for (char letter = take(); letter != '\''; letter = take()) word += letter;
  }
  // A backslash is itself here, unless it stands before what would else mean something.
  void read_double(std::string& word) {
    for (char letter = take(); letter != '"'; letter = take()) {
      if (letter == '\\') {
        letter = take();
        if (letter != '"' && letter != '\\' && letter != '$' && letter != '`') word += '\\';
      }
      word += letter;
    }
  }

  std::string_view rest_;
};

struct Counted {
  pid_t process;
  double seconds;  // at the last reading: a process that has ended reports nothing more
};

struct Ledger {
  std::mutex mutex;
  std::vector<Counted> running;
  double ended_seconds = 0;
  // A process that counts no others costs nothing extra, and its fork does not count them twice.
  std::atomic<pid_t> owner = 0;
};

Ledger& ledger() {
  static Ledger only;
  return only;
}

void look(Counted& one) {
  clockid_t clock{};
  timespec now{};
  if (clock_getcpuclockid(one.process, &clock) == 0 && clock_gettime(clock, &now) == 0)
    one.seconds = std::max(
        one.seconds, static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec));
}

}  // namespace

std::string shell_word(std::string_view word) {
  if (!word.empty() && std::ranges::all_of(word, is_literal)) return std::string(word);
  std::string quoted = "'";
  for (const char letter : word)
    if (letter == '\'')
      quoted += "'\\''";  // ends the quotes, a quoted quote, begins them again
    else
      quoted += letter;
  return quoted + "'";
}

std::vector<std::string> shell_words(std::string_view command) {
  WordReader reader(command);
  std::vector<std::string> words;
  for (std::string word; reader.read(word);) words.push_back(word);
  require(!words.empty(), "a command must have at least one word");
  return words;
}

// Processor time of other processes, by the clock that each of them has.

CountedProcess::CountedProcess(pid_t process) : process_(process) {
  const std::lock_guard lock(ledger().mutex);
  if (ledger().owner != getpid()) {
    ledger().running.clear();
    ledger().ended_seconds = 0;
    ledger().owner = getpid();
  }
  ledger().running.push_back({process, 0});
}

CountedProcess::~CountedProcess() {
  const std::lock_guard lock(ledger().mutex);
  const auto mine = std::ranges::find(ledger().running, process_, &Counted::process);
  if (mine == ledger().running.end()) return;  // of a process that this one was forked from
  look(*mine);
  ledger().ended_seconds += mine->seconds;
  ledger().running.erase(mine);
}

bool counts_processes() { return ledger().owner != 0 && ledger().owner == getpid(); }

double counted_processor_seconds() {
  if (!counts_processes()) return 0;
  const std::lock_guard lock(ledger().mutex);
  double sum = ledger().ended_seconds;
  for (Counted& one : ledger().running) {
    look(one);
    sum += one.seconds;
  }
  return sum;
}

}  // namespace isoline
