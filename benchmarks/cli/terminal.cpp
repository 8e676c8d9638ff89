// Prints progress, outcomes and reports on a terminal.
#include "benchmarks/cli/terminal.h"

#include <fcntl.h>
#include <fmt/ranges.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "benchmarks/cli/left_out.h"
#include "benchmarks/plan/claim_cells.h"
#include "benchmarks/run/progress.h"
#include "benchmarks/run/runner.h"
#include "core/columns.h"
#include "core/foreign/foreign.h"
#include "core/shell.h"
#include "core/text.h"
#include "reports/sections/contrasts.h"
#include "reports/sections/words.h"

namespace isoline::benchmarks {

std::string_view embedded_raw_conduct();

namespace {

namespace fs = std::filesystem;

// The binary itself: a debugger can't follow the launcher.
std::string program_path() {
  std::error_code unknown;
  const fs::path path = fs::read_symlink("/proc/self/exe", unknown);
  return shell_word(unknown ? "isoline" : path.string());
}

// As the system names it: "core", or a program that takes it.
std::string core_pattern() {
  std::string pattern;
  std::getline(std::ifstream("/proc/sys/kernel/core_pattern"), pattern);
  return pattern.empty() ? "core" : pattern;
}

// The next steps after a crash: its record and the parts of it that say most, the command that
// repeats it in one process, under a debugger or for a core file, and where the core file would be.
std::string debugging_advice(const Crash& crash, const fs::path& folder) {
  const std::string command = fmt::format("{} run {} --in-process", program_path(),
                                          reports::rerun_arguments(crash.request));
  return fmt::format(
      "to debug {}:\n"
      "  its record      {}: \"message\" is the cause, \"output\" the last output\n"
      "  in one process  {}\n"
      "  in a debugger   gdb --args {}\n"
      "  with core file  ulimit -c unlimited; {}\n"
      "                  the system writes it to: {}\n",
      title_of(crash.request), (folder / crash.record).string(), command, command, command,
      printable(core_pattern()));
}

// The exit status of another program, which has ended.
int status_of_program(std::vector<std::string> command, const char* package,
                      const fs::path& output) {
  std::vector<char*> words;
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  constexpr int kMode = 0644;
  if (!output.empty())
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, kMode);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, words[0], &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  require(failed == 0, [&] {
    return fmt::format(
        "this needs the program {0}, which does not start; on Debian, "
        "`apt-get install {1}` installs it",
        command[0], package);
  });
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return status;
}

}  // namespace

void run_program(std::vector<std::string> command, const char* package, const fs::path& output) {
  const int status = status_of_program(command, package, output);
  require(WIFEXITED(status) && WEXITSTATUS(status) == 0, [&] {
    return fmt::format("the program {} failed: {}", command[0], fmt::join(command, " "));
  });
}

int run_script(const std::string& name, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"python3", (client_folder("python") / name).string()});
  const int status = status_of_program(std::move(arguments), "python3", {});
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? kGood : kUsage;
}

reports::Columns output_columns() {
  constexpr std::size_t kFewest = 60;
  if (isatty(STDOUT_FILENO) == 0) return {};
  const std::size_t columns = std::max(kFewest, terminal_width(STDOUT_FILENO));
  return {.prose = columns, .table = columns};
}

Listener progress_on_terminal(const char* what) {
  if (Progress::style_of(STDERR_FILENO) != Progress::Style::live) return {};
  return [what, line = std::shared_ptr<Progress>()](std::size_t done, std::size_t all) mutable {
    if (line == nullptr)
      line = std::make_shared<Progress>(Progress::Style::live, what, std::int64_t(all), 0);
    line->reached(std::int64_t(done));
    line->show();
  };
}

void print_failures(const Outcome& outcome, const std::filesystem::path& folder) {
  constexpr std::size_t kMost = 20;
  for (std::size_t i = 0; i < std::min(kMost, outcome.failures.size()); ++i)
    say(stderr, fmt::format("{}\n", outcome.failures[i]));
  if (outcome.failures.size() > kMost)
    say(stderr, fmt::format("… and {} more failures\n", outcome.failures.size() - kMost));
  if (outcome.crash) say(stderr, debugging_advice(*outcome.crash, folder));
}

void print_outcome(const Outcome& outcome, const std::filesystem::path& folder, bool quiet) {
  print_failures(outcome, folder);
  for (const std::string& name : outcome.conflicts)
    say(stderr, fmt::format("{}: the results of its repetitions differ\n", name));
  for (const std::string& remark : outcome.remarks) say(stderr, remark + "\n");
  if (!outcome.missing.empty())
    say(stderr, fmt::format("{} of {} disappeared during the run, the first one is that of {}; "
                            "repeat the command to run the missing cells again\n",
                            reports::counted(outcome.missing.size(), "record"), outcome.planned,
                            outcome.missing.front()));
  if (outcome.reused_from_other_builds > 0)
    say(stderr, fmt::format("{} of {} reused, although another build computed them\n",
                            outcome.reused_from_other_builds,
                            reports::counted(std::size_t(outcome.reused), "cell")));
  for (const std::string& problem : outcome.solved_at_start)
    say(stderr,
        fmt::format("the start of {} solves it, so that its runs compare nothing\n", problem));
  if (quiet) return;
  if (outcome.continued > 0)
    say(stderr, fmt::format("{} continued from the end of a run with a smaller budget\n",
                            reports::counted(std::size_t(outcome.continued), "cell")));
  std::string counts;
  for (const auto& [status, count] : outcome.statuses)
    counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, name_of(status));
  say(stdout, fmt::format("{}: {} new, {} reused.{} Time: {}\n",
                          reports::counted(std::size_t(outcome.planned), "cell"), outcome.run,
                          outcome.reused, counts.empty() ? "" : " Status: " + counts + ".",
                          duration_text(outcome.seconds)));
}

int exit_code_of(const Outcome& outcome) {
  if (outcome.is_interrupted) {
    say(stderr, "interrupted; repeat the command to continue the run\n");
    return kInterrupted;
  }
  if (outcome.interrupted > 0) {
    say(stderr,
        fmt::format(
            "{} interrupted: killed by another program, or the script was edited during the run; "
            "repeat the command to run the missing cells\n",
            reports::counted(std::size_t(outcome.interrupted), "cell")));
    return kInterrupted;
  }
  const bool is_whole = outcome.missing.empty();
  return is_whole && outcome.failures.empty() && outcome.conflicts.empty() ? kGood : kWorse;
}

reports::Study study_of_report(const std::vector<std::string>& folders, Session& session) {
  std::set<std::string> claimed;
  for (const Request& request : cells_of(session.claims(), true)) claimed.insert(request.cell);
  reports::Study study = reports::read_study(
      folders, progress_on_terminal("reading records"),
      [&](Record& record) { reports::trim_for_report(record, claimed.contains(record.cell)); });
  if (study.runs.empty()) say_left_out(study.unreadable);
  require(!study.runs.empty(), [&] {
    const std::string damaged =
        study.unreadable.empty() ? ""
                                 : fmt::format(", and {} that cannot be read",
                                               reports::counted(study.unreadable.size(), "file"));
    return fmt::format("no records in {}{}; `isoline run --out FOLDER` creates some",
                       fmt::join(folders, ", "), damaged);
  });
  return study;
}

namespace {

// Libraries that are called without Isoline, by a counter within the callback.
reports::Table raw_conduct() {
  const Json raw = parse_json(std::string(embedded_raw_conduct()), "conduct.json");
  reports::Table table = reports::worded_table("conduct-raw");
  const std::vector<std::string> columns = table.columns;
  table.parts = {4, 4, 3};
  for (const auto& [method, cells] : raw.at("methods").items()) {
    auto& row = table.rows.emplace_back();
    row.emplace_back(method);
    for (std::size_t i = 1; i < columns.size(); ++i) {
      const Json& cell = cells.at(columns[i]);
      const std::string mark = cell.at("mark"), rule = raw.at("rules").at(columns[i]);
      row.emplace_back(mark + " " + cell.at("figures").get<std::string>());
      row.back().note = fmt::format("{}. {}", fmt::join(cell.at("runs"), ", "), rule);
    }
  }
  return table;
}

// Where the results have no table of conduct of their own, the published one of their methods.
void add_published_conduct(reports::Document& document) {
  reports::Section& own = *std::ranges::find(document.sections, "conduct", &reports::Section::id);
  if (own.is_empty()) {
    std::vector<AuditedOptimizer> all =
        audit_from_text(std::string(embedded_conduct()), "conduct.json");
    std::erase_if(all, [&](const AuditedOptimizer& one) {
      return std::ranges::none_of(document.comparison.optimizers,
                                  [&](const auto& axis) { return axis.method == one.name; });
    });
    own = reports::conduct_section(all);
    own.lead +=
        " These figures are published with Isoline; isoline audit --conduct --out FOLDER replaces "
        "them by your own.";
  }
  own.tables.push_back(raw_conduct());
}

}  // namespace

reports::Document document_of_report(const reports::Study& study, Session& session,
                                     const reports::Yardstick& yardstick) {
  std::vector<reports::Judgement> claims = reports::judge(json_of(session.claims()), study.runs);
  std::erase_if(claims, [](const reports::Judgement& judgement) { return !judgement.is_covered; });
  reports::Yardstick own = yardstick;
  own.has_contrasts = reports::has_contrasts(study);
  reports::Document document =
      reports::document_of(reports::compare_optimizers(study, own), std::move(claims));
  add_published_conduct(document);
  return document;
}

void write_and_print(const reports::Study& study, const std::filesystem::path& out,
                     Session& session, const Reporting& how) {
  reports::Document document = document_of_report(study, session, how.yardstick);
  document.out = out.string();
  reports::write_report(document, out);
  if (!how.is_quiet)
    say(stdout, fmt::format("{}\nreport: {}\n", reports::terminal_table(document, output_columns()),
                            (out / "index.html").string()));
}

}  // namespace isoline::benchmarks
