// Help, versions, error messages of the command line, and output on a terminal.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "core/records/provenance.h"
#include "core/text.h"
#include "tests/cli/shell.h"

namespace isoline::benchmarks {
namespace {

const std::string kVerbs =
    "run merge replay report figures site compare solution baseline claims export describe check audit "
    "new tune train validate help version ";

TEST(Help, OfTheProgramAndOfEveryVerbIsWrittenOutAndGood) {
  const Shell shell;
  const Finished program = shell.expect("./isoline --help");
  EXPECT_EQ(program.err, "");
  std::istringstream verbs(kVerbs);
  for (std::string verb; verbs >> verb;) {
    EXPECT_TRUE(contains(program.out, verb)) << verb;
    const Finished help =
        shell.expect("./isoline " + verb + " --help", {.out = {"Examples:\n  isoline " + verb}});
    EXPECT_EQ(shell("./isoline help " + verb).out, help.out) << verb;
    EXPECT_EQ(help.err, "") << verb;
    EXPECT_GE(count_lines(help.out), 4U) << verb;
    std::istringstream lines(help.out);  // in a pipe they fit 80 columns
    for (std::string line; std::getline(lines, line);)
      EXPECT_LE(std::ranges::count_if(line, [](char c) { return (c & 0xC0) != 0x80; }), 80) << line;
  }
  EXPECT_EQ(shell("./isoline completion words | cut -f 1 | tr '\\n' ' '").out,
            kVerbs + "--help --version ");
  EXPECT_EQ(shell.expect("./isoline help").out, program.out);
  EXPECT_EQ(shell.expect("./isoline").out, program.out);
}

// The commands that a release keeps under their earlier names: each runs the present one, with its
// exit code, and one line of standard error.
TEST(OldNames, RunThePresentCommandsWithOneLineOfAdvice) {
  const Shell shell;
  shell.expect(
      "./isoline run --problem square --optimizer gd,newton --out out --no-report --quiet");
  for (const auto& [old, present] : std::vector<std::pair<std::string, std::string>>{
           {"plan --problem square --optimizer gd --json",
            "run --dry-run --problem square --optimizer gd --json"},
           {"status out", "run out --dry-run"},
           {"status absent", "run ./absent --dry-run"},
           {"list networks", "describe networks"},
           {"choose out --have gradient", "report out --view choice --have gradient"},
           {"best out --out a.json", "baseline out --best a.json"},
           {"score --optimizer gd --peers=newton --problem rosenbrock --out digits --jobs 1",
            "run nist --instead gd,newton --problem rosenbrock --out digits --no-report --jobs 1 "
            "--view digits"},
           {"infer absent.json --input x.csv --output y.csv",
            "solution absent.json --input x.csv --out y.csv"},
           {"help plan", "help run"}}) {
    shell("./isoline " + old);  // the second time, nothing is left to run
    const Finished before = shell("./isoline " + old), now = shell("./isoline " + present);
    EXPECT_EQ(before.exit_code, now.exit_code) << old << before.err << now.err;
    const auto untimed = [](const std::string& text) { return text.substr(0, text.find("Time")); };
    EXPECT_EQ(untimed(before.out), untimed(now.out)) << old;
    EXPECT_EQ(count_lines(before.err), count_lines(now.err) + 1) << old << ": " << before.err;
  }
}

TEST(Help, OfTuneAsksForTheProblemsOnce) {
  const std::string help =
      Shell().expect("./isoline tune --help", {.out = {"SPEC", "--problem"}}).out;
  EXPECT_FALSE(contains(help, "REQUIRED")) << help;
}

TEST(Help, VersionIsOneLine) {
  const Finished version = Shell().expect("./isoline --version");
  EXPECT_EQ(Shell()("./isoline version").out, version.out);
  EXPECT_TRUE(version.out.starts_with("isoline ")) << version.out;
  EXPECT_EQ(count_lines(version.out), 1U);
}

// A command that is wrong, and what the one sentence about it must contain.
const std::vector<std::pair<std::string, std::string>> kMistakes = {
    {"rnu", "did you mean 'run'"},
    {"import", "unknown command 'import'; known: "},
    {"--verson", "did you mean --version"},
    {"run --problm square", "did you mean --problem"},
    {"run quick twice", "run: unexpected argument 'twice'"},
    {"run --problem", "--problem needs a value"},
    {"run --seeds 3 --seeds 4", "--seeds occurs more than once"},
    {"run --quiet=5", "--quiet takes no value"},
    {"describe adan", "did you mean 'adam'"},
    {"run --problem 'python3 mine.py' --optimizer gd", "process[command="},
    {"describe zzzz", "`isoline describe` "},
    {"audit zzzz", "unknown optimizer 'zzzz'; "},
    {"audit square", "isoline check square"},
    {"run --problem square --optimizer lm", "levenberg-marquardt-cg"},
    {"run --suite quick", "give its value alone"},
    {"plot", "did you mean 'figures'"},
    {"report . --by tim", "did you mean 'time'"},
    {"solution absent.json --input x.csv --out y.csv", "absent.json: no such file"},
    {"train rosenbrock --out net.json",
     "burgers, coupled-oscillators, exponential, heat, hig-toy, linear-chain, navier-stokes"},
    {"run --problem 'rosenbrock[mode=learn]'", "rosenbrock cannot train a network"},
    {"claims sip-bettr-in-x", "did you mean 'sip-better-in-x-worse-in-loss'"},
    {"claims zzzz", "`isoline claims --list --all`"},
    {"run quick --in-process --dry-run", "--dry-run"},
    {"run quick --shard 5/4", "1 ≤ I ≤ N"},
    {"run quick --shard auto", "ISOLINE_SHARD, SLURM_ARRAY_TASK_ID"},
    {"run quick --dry-run --shards 0", "--shards"},
    {"run .", "--dry-run"},
    {"run . --dry-run", ".: no such result folder"},
    {"run quick --shards 3", "--dry-run"},
    {"run quick --optimizer gd --instead adam", "--instead"},
    {"report . --bounds", "--view"},
    {"run quik", "did you mean 'quick'"},
    {"run --problem square --optimizer 'adam[beta3=1]'", "did you mean 'beta"},
    {"run --problem 'sine[xi=-3]' --optimizer gd", "sine: xi must"},
    {"run --problem 'sine[xi=1' --optimizer gd", "has a [ without a ]"},
    {"run --problem square --optimizer gd --seeds 5..3", "5..3"},
    {"run --problem square --optimizer gd --memory lots", "2GB, got 'lots'"},
    {"run --problem square --optimizer gd --memory 100MB", "between 256MB and 1024TB"},
    {"run --problem square --optimizer gd --memory=-1", "got '-1'"},
    {"solution net.json --input y.csv --out x.csv --memory 1MB", "between 16MB and 1024TB"},
    {"run --problem square --optimizer gd --memory 999999999999TB", "got '999999999999TB'"},
    {"run --problem square --optimizer gd --time ''", "such as 10s, 2m or 1h, got ''"},
    {"run --problem square --optimizer gd --time -3", "--time: a time"},
    {"run --problem square --optimizer gd --time 1e300", "--time: a time"},
    {"run --problem square --optimizer gd --seeds ''", "--seeds: it must not"},
    {"run --problem square --optimizer gd --out ''", "--out: it must not"},
    {"run --problem square --optimizer gd --seeds 0", "--seeds: the number"},
    {"run --problem square --optimizer gd --best nowhere.json", "nowhere.json"},
    {"run --problem square --optimizer gd --plugin nowhere.so", "--plugin: nowhere.so"},
    {"run --problem square --optimizer 'gd[lr=1,rate=2]'", "rate is set twice"},
    {"run --problem 'heat[network=abc]' --optimizer gd", "network=abc requires mode=learn"},
    {"run --problem 'heat[batch=7]' --optimizer gd", "batch=7 requires mode=learn"},
    {"run --problem 'hig-toy[mode=direct]' --optimizer gd", "has only mode=learn"},
    {"run --problem 'navier-stokes[N=4]' --optimizer gd", "N must be in [6, 128]"},
    {"run --problem square --optimizer gd --seeds 0..18446744073709551615",
     "more than 10^19 seeds"},
    {"run --seeds 0..999999", "1,000,000 seeds × "},
    {"run --problem 'sine[xi=1|2],square' --optimizer gd --seeds 1000000",
     "3,000,000 cells, more than 1,000,000: 1,000,000 seeds × 3 "},
    {"run --problem square --optimizer gd,newton --seeds 1000000", "--allow-large lifts the limit"},
    {"run --problem square --optimizer gd --jobs 0", "from 1 to 1,024"},
    {"run --problem square --optimizer gd --jobs 2.5", "--jobs must be"},
    {"run --problem square --optimizer gd --iterations 99999999999999999999999",
     "from 1 to 1,000,000,000,000,000"},
    {"run --problem square --optimizer gd --iterations 0", "--iterations must be"},
    {"run --problem square --optimizer gd --work -1", "--work must be"},
    {"run --problem square --optimizer gd --target nan", "--target must be a number"},
    {"run --problem square --optimizer gd --retry failed,crashd", "did you mean 'crashed'"},
    {"check square --seed -1", "--seed must be"},
    {"check square --seed 18446744073709551616", "--seed must be"},
    {"report . --tolerance 1e-12", "in [1e-10, 1]"},
    {"compare . . --noise inf", "in [0, 10]"},
    {"tune square --tuning-seeds 0..9999999", "at most 1,000,000"},
    {"tune square --optimizer gd --grid rate=1e-2..1e-1x2000000000", "at most 1,000 values"},
    {"replay nowhere.json", "nowhere.json"},
    {"replay .", "is a folder"},
    {"run notebook --optimizer ceres-lm", "ceres-lm"},
    {"run notebook --problem brown-dennis", "brown-dennis"},
    {"run quick --all", "--dry-run"},
    {"tune", "pass SPEC, --problem or --suite"},
    {"tune square --problem square", "--problem"},
    {"report .", "no records in .; "},
    {"run --rates nowhere.json", "nowhere.json"},
    {"run --problem 'rosenbrock[sigma=\"three.csv\"]' --optimizer gd", "three.csv: sigma must"},
    {"check rosenbrok", "did you mean 'rosenbrock'"},
    {"validate nowhere", "nowhere: no such"},
    {"report nowhere", "nowhere: no such"},
    {"compare nowhere .", "nowhere: no such"},
    {"compare . . --json --markdown", "--json"},
    {"run --problem square --optimizer gd --rates wrong.json", "wrong.json violates the schema"},
    {"compare . . --allow wrong.json", "wrong.json violates the schema"},
    {"merge nowhere --out results", "nowhere"},
    {"claims --no-run --out nowhere", "nowhere"},
    {"completion tcsh", "tcsh"},
    {"export . --format tsv --out x", "tsv"},
    {"export . --out x.csv", "no records in .; "},
    {"export nowhere.tar.gz --out x.csv", "nowhere.tar.gz"},
    {"describe problms", "problms"}};

TEST(Usage, MistakesAreOneSentenceWithASuggestionAndExitOne) {
  const Shell shell;
  write_text(shell.folder() / "wrong.json", "{\"rows\": [1]}");
  write_text(shell.folder() / "three.csv", "1\n2\n3\n");
  for (const auto& [command, sentence] : kMistakes) {
    const Finished result =
        shell.expect("./isoline " + command, {.exit_code = 1, .err = {sentence}});
    EXPECT_EQ(result.out, "") << command;
    EXPECT_TRUE(result.err.starts_with("isoline: ")) << command << ": " << result.err;
    EXPECT_EQ(count_lines(result.err), 1U) << command << ": " << result.err;
    EXPECT_LE(result.err.size(), 400U) << command << ": a list, no sentence";
  }
  EXPECT_FALSE(std::filesystem::exists(shell.folder() / "results")) << "a mistake left a folder";
  const Finished no_folder =
      shell.expect("touch file; ./isoline run --problem square --optimizer gd --out file/deep",
                   {.exit_code = 1, .err = {"file/deep"}});
  EXPECT_EQ(count_lines(no_folder.err), 1U) << no_folder.err;
}

TEST(Describe, TellsEveryComponentInWordsAndInJson) {
  const Shell shell;
  for (const std::string name : {"sine", "hig", "ceres-gauss-newton", "poisson[N=8]"}) {
    shell.expect("./isoline describe '" + name + "'", {.out = {"Source", "ption"}});
    const Finished json = shell("./isoline describe '" + name + "' --json");
    EXPECT_EQ(parse_json(json.out, name).at("schema"), "isoline.component/1") << name;
    EXPECT_EQ(json.err, "") << name;
  }
}

TEST(Describe, TellsTheGivenValueBesideTheDefault) {
  const Shell shell;
  shell.expect("./isoline describe 'adam[rate=0.1]'",
               {.out = {"rate                          0.1  ", "(default: 0.001)"}});
  EXPECT_FALSE(contains(shell("./isoline describe adam").out, "(default:"));
  shell.expect("./isoline describe 'mlp[layers=6-6]'", {.out = {" 6-6  "}});
  shell.expect("./isoline describe 'adam[rate=-1]'", {.exit_code = 1});
}

TEST(Describe, TellsEveryPrivilegeThatAMethodCanHave) {
  const Shell shell;
  shell.expect("./isoline describe sip", {.out = {"Extra info  exact inverse", "; damped inverse",
                                                  "; approximate inverse", "; estimate "}});
  shell.expect("./isoline describe 'sip[inverse=newton]'",
               {.out = {"Extra info  exact Hessian\n"}});
  shell.expect("./isoline describe adam", {.out = {"Extra info  none\n"}});
}

TEST(List, NamesEverythingInWordsAndInJson) {
  const Shell shell;
  const Finished words = shell("./isoline describe"), json = shell("./isoline describe --json");
  const Json all = parse_json(json.out, "list");
  EXPECT_GE(all.at("problems").size(), 16U);
  EXPECT_GE(all.at("optimizers").size(), 33U);
  EXPECT_GE(all.at("suites").size(), 3U);
  for (const Json& entries : all)
    for (const Json& entry : entries)
      EXPECT_TRUE(contains(words.out, entry.at("name").get<std::string>()));
  EXPECT_EQ(json.err, "");
}

TEST(Check, OfASoundProblemPassesWithFigures) {
  const Shell shell;
  shell.expect("./isoline check 'rosenbrock,poisson[N=8]'", {.out = {"pass", " 0 failed"}});
  const Json json = parse_json(shell("./isoline check rosenbrock --json").out, "check");
  EXPECT_GE(json.at("rosenbrock").size(), 3U);
}

// By the program, and by the scripts in their shells. zsh completes in a terminal only, so its
// script meets functions in place of its builtins.
TEST(Completion, CompletesNamesInEveryShell) {
  const Shell shell;
  shell.expect(
      "for each in bash zsh fish; do ./isoline completion $each > c.$each || exit; done; "
      "bash -n c.bash");
  const std::map<std::string, std::string> shells = {
      {"bash",
       "source c.bash; COMP_WORDS=(./isoline {}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); "
       "_isoline; echo ${{COMPREPLY[@]}}"},
      {"zsh",
       "compdef() {{ }}; compadd() {{ echo $names }}; source ./c.zsh; words=(./isoline {}); "
       "CURRENT=$#words; _isoline"},
      {"fish", "source c.fish; echo (complete -C \"./isoline {}\" | string split -f1 \\t)"}};
  const auto complete = [&](const std::string& words) {
    std::string first;
    for (const auto& [name, script] : shells) {
      if (shell("command -v " + name).exit_code != 0) continue;
      write_text(shell.folder() / "complete", fmt::format(fmt::runtime(script), words) + "\n");
      const Finished found = shell(name + " complete");
      if (first.empty()) first = found.out;
      EXPECT_EQ(found.out, first) << name << ": " << found.err;
    }
    return first;
  };
  for (const auto& [words, completion] : std::vector<std::pair<std::string, std::string>>{
           {"run --problem rosen", "rosenbrock"},
           {"run --optimizer levenberg", "levenberg-marquardt levenberg-marquardt-cg"},
           {"run --optimizer gd,gauss", "gd,gauss-newton"},
           {"run note", "notebook"},
           {"describe saddle", "saddle-free-newton"},
           {"val", "validate"},
           {"repl", "replay"},
           {"help valid", "validate"},
           {"claims sip-better-in", "sip-better-in-x-worse-in-loss"},
           {"report results --view di", "digits"},
           {"describe fn", "fno"},
           {"run --retry f", "failed"},
           {"completion z", "zsh"},
           {"export results --format cs", "csv"},
           {"run --dry", "--dry-run"}})
    EXPECT_EQ(complete(words), completion + "\n") << words;
}

TEST(Manual, HasEveryVerbAndOptionAndIsCleanRoff) {
  const Shell shell;
  const std::string page = shell.expect("./isoline man > isoline.1; cat isoline.1").out;
  std::istringstream verbs(kVerbs);
  for (std::string verb; verbs >> verb;) EXPECT_TRUE(contains(page, ".SS isoline " + verb));
  EXPECT_TRUE(contains(page, ".TP\n\\fB\\-\\-shard\\fR TEXT\n"));
  EXPECT_TRUE(contains(page, "Values: csv, runs, coco."));
  if (shell("command -v groff").exit_code != 0) return;
  const Finished shown = shell.expect("groff -man -Kutf8 -Tutf8 -P-cbou -ww isoline.1",
                                      {.out = {"NAME", "--keep-state"}});
  EXPECT_EQ(shown.err, "");
}

// Foreign text is printed without its control sequences, and paths may have any bytes.

constexpr const char* kEscape = "\x1b";

// A shell that knows no $'…' makes the bytes by printf.
TEST(ForeignText, AFolderWhoseNameIsNoUtf8IsAFolder) {
  const Shell shell;
  shell.expect(
      "./isoline run --problem square --optimizer gd --iterations 3 --quiet "
      "--out \"$(printf 'x\\377')\"");
  EXPECT_EQ(count_records(shell.folder() / "x\xff"), 1U);
  const Finished again = shell.expect(
      "./isoline report \"$(printf 'x\\377')\" && ./isoline validate \"$(printf 'x\\377')\"");
  EXPECT_EQ(valid_utf8(again.out), again.out);
}

TEST(ForeignText, NoControlSequenceOfAFileOrAnArgumentReachesTheTerminal) {
  const Shell shell;
  write_text(shell.folder() / "schema.json", R"({"schema": "isoline.\u001b[2Jrun/1"})");
  write_text(shell.folder() / "numbers.csv", "1,2\n3,\x1b]0;owned\x07\n");
  for (const char* command :
       {"./isoline validate schema.json", "./isoline describe \"$(printf '\\033[31mred')\"",
        "./isoline run --dry-run --problem \"$(printf 'sine[\\033[2J=1]')\" --optimizer gd",
        "./isoline solution none.json --input numbers.csv --out out.csv",
        "./isoline report \"$(printf 'no\\033[1mfolder')\""}) {
    const Finished run = shell(command);
    EXPECT_NE(run.exit_code, 0) << command;
    EXPECT_FALSE(contains(run.out + run.err, kEscape)) << command;
    EXPECT_NE(run.out + run.err, "") << command;
  }
  EXPECT_TRUE(contains(shell("./isoline validate schema.json").out, "\\u001b[2J"));
}

TEST(ForeignText, ARecordsMessageIsShownAsTextAndKeptAsItIs) {
  const Shell shell;
  shell.expect(
      "./isoline run --problem square --optimizer gd --iterations 3 --quiet --no-report --out r");
  const std::string change =
      "sed -i 's/\"status\":\"[a-z]*\"/\"status\":\"failed\"/;"
      "s/\"message\":\"[^\"]*\"/\"message\":\"\\\\u001b[2J\"/' r/runs/*.json && ";
  const Finished report = shell(change + "./isoline report r");
  EXPECT_FALSE(contains(report.err, kEscape)) << report.err;
  const Finished printed = shell.expect("./isoline report r");
  EXPECT_FALSE(contains(printed.out + printed.err, kEscape));
}

// Output on a terminal: summaries first, short lists, durations, and the next command after a
// crash.

// A file that is opened must not get what belongs on the terminal, and a full disk is reported.
TEST(Terminal, ClosedAndFullStreamsAreNoticed) {
  const Shell shell;
  shell.expect("./isoline run --problem square --optimizer gd --out out --no-report 2>&-");
  EXPECT_TRUE(std::filesystem::is_empty(shell.folder() / "out" / "cells.lock"));
  for (const char* verb : {"describe gd", "check square", "report out"})
    shell.expect(std::string("./isoline ") + verb + " >/dev/full",
                 {.exit_code = 2, .err = {"No space left"}});
}

// A limit of the size of a file, which is a signal to a program that does not expect it.
TEST(ForeignText, ANameThatIsTooLongIsAMessage) {
  const Shell shell;
  shell.expect("./isoline site " + std::string(300, 'x') + " --out page",
               {.exit_code = 2, .err = {"isoline: xxx", "xxx: File name too long"}});
}

TEST(Terminal, AFileThatMayNotGrowIsAMessage) {
  Shell().expect(
      "./isoline describe --json >/dev/null && (ulimit -f 2; ./isoline describe --json >big)",
      {.exit_code = 2, .err = {"File too large"}});
}

TEST(Terminal, ARunSaysHowLongItTook) {
  const Finished result =
      Shell()("./isoline run --problem square --optimizer newton --no-report --out out");
  EXPECT_TRUE(
      std::regex_search(result.out, std::regex(R"(^1 cell: 1 new, 0 reused\. .* \d+\.\d s\n)")))
      << result.out;
}

// The command `script` is a terminal; every run shows its progress once it has ended.
TEST(Terminal, AProgressBarIsInColourWhereThatIsWanted) {
  const Shell shell;
  if (shell("command -v script").exit_code != 0) GTEST_SKIP() << "no program `script`";
  const auto output = [&](const std::string& settings) {
    return shell("env -u NO_COLOR " + settings +
                 " script -qec './isoline run --problem square --optimizer gd --no-report "
                 "--force --out out' /dev/null")
        .out;
  };
  const std::string bar = "████████████████████", green = "\x1b[32m";
  EXPECT_TRUE(contains(output("TERM=xterm"), green + bar));
  const std::string plain = output("TERM=xterm NO_COLOR=1");
  EXPECT_TRUE(contains(plain, bar)) << plain;
  EXPECT_FALSE(contains(plain, green)) << plain;
  EXPECT_TRUE(contains(output("TERM=xterm NO_COLOR="), green + bar)) << "empty: not set";
  EXPECT_FALSE(contains(output("TERM=dumb"), kEscape));
}

TEST(Terminal, AnOptionOfSpecificationsMayBeRepeated) {
  const std::string once = "./isoline run --problem square,scaling --optimizer gd,adam --dry-run";
  const Shell shell;
  const Finished twice = shell(
      "./isoline run --problem square --problem scaling --optimizer gd --optimizer adam --dry-run");
  EXPECT_TRUE(twice.out.starts_with("4 cells")) << twice.out;
  EXPECT_EQ(twice.out, shell(once).out);
}

TEST(Terminal, ClaimsAreCountedThenListedTwentyAtMost) {
  const Shell shell;
  const std::string few = shell("./isoline claims --list").out;
  EXPECT_TRUE(std::regex_search(few, std::regex(R"(^\d+ claims in \d+ groups: )"))) << few;
  EXPECT_LE(count_lines(few), 30U) << "twenty claims, their groups and the summary";
  EXPECT_TRUE(few.ends_with("; --all lists them\n")) << few;
  EXPECT_GT(count_lines(shell("./isoline claims --list --all").out), 100U);
}

TEST(Terminal, VerdictsOnClaimsAreCountedThenListedTwentyAtMost) {
  const Shell shell;
  shell("./isoline run --problem square --optimizer gd --no-report --quiet --out out");
  const Finished few = shell("./isoline claims --no-run --out out");
  EXPECT_TRUE(std::regex_search(few.out, std::regex(R"(^\d+ facts in \d+ claims: )"))) << few.out;
  EXPECT_LE(count_lines(few.out), 30U) << few.out;
  EXPECT_TRUE(contains(few.out, "; --all lists them\n")) << few.out;
  EXPECT_GT(count_lines(shell("./isoline claims --no-run --all --out out").out), 200U);
}

TEST(Terminal, AnAuditSaysWhatItFoundThenTwentyLines) {
  const Shell shell;
  const Finished few = shell("./isoline audit gd adam sip newton gauss-newton ceres-lm");
  EXPECT_TRUE(few.out.starts_with("Scaling: ")) << few.out;
  EXPECT_TRUE(contains(few.out, "… and 4 more rows; --all lists")) << few.out;
  const Finished all = shell("./isoline audit gd adam sip newton gauss-newton ceres-lm --all");
  EXPECT_FALSE(contains(all.out, "; --all lists")) << all.out;
  EXPECT_GT(count_lines(all.out), count_lines(few.out));
}

TEST(Terminal, ATuningIsATableWithBarsAndJsonOnRequest) {
  const Shell shell;
  const std::string tune = "./isoline tune square --optimizer gd --work 50 --out t ";
  const Finished table = shell.expect(tune, {.out = {"█"}});
  EXPECT_TRUE(table.out.starts_with("1 pair tuned: ")) << table.out;
  const Json rows = parse_json(shell(tune + "--json").out, "rows");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].at("optimizer"), "gd");
}

TEST(Terminal, ATuningSaysEdgesAndTies) {
  const Shell shell;
  const std::string tune = "./isoline tune square --work 60 --tuning-seeds =100 --out t ";
  shell.expect(tune + "--optimizer gd --grid rate=1e-9..1e-7x3",
               {.out = {"1 with the best ", ", 0 with a tie", "the highest value tried"}});
  shell.expect(tune + "--optimizer levenberg-marquardt --grid initial-damping=1e-300..1e-299x2",
               {.out = {"0 with the best ", ", 1 with a tie", "ties with "}});
}

TEST(Terminal, CellsRunInOneProcessForADebuggerAndLeaveNoRecord) {
  const Shell shell;
  shell.expect("./isoline run --problem square --optimizer newton,gd --in-process",
               {.out = {"square × newton, seed 0: ", "writes no records"}});
  EXPECT_FALSE(std::filesystem::exists(shell.folder() / "results"));
}

TEST(Terminal, ACrashSaysHowToDebugItAndTheCommandCrashesAgain) {
  const Shell shell;
  const Finished result =
      shell.expect(OWN_BINARY " run --problem aborter --optimizer gd --out out --no-report",
                   {.exit_code = 2,
                    .err = {"crashed: signal 6", "\"message\" is the cause", "gdb --args ",
                            "ulimit -c unlimited"}});
  std::smatch found;
  ASSERT_TRUE(std::regex_search(result.err, found, std::regex(R"(record +(out/runs/\S+\.json):)")))
      << result.err;
  EXPECT_TRUE(std::filesystem::exists(shell.folder() / found[1].str())) << found[1];
  ASSERT_TRUE(
      std::regex_search(result.err, found, std::regex(R"(in one process +(.*--in-process)\n)")))
      << result.err;
  const Finished again = shell("ulimit -c 0; " + found[1].str());
  EXPECT_NE(again.exit_code, 0);
  EXPECT_FALSE(contains(again.out, "writes no records")) << "it ended before";
}

TEST(Terminal, AComparisonBeginsWithItsVerdictAndIsShort) {
  const Shell shell;
  const std::string run = "./isoline run --problem square,sine --no-report --quiet --seeds 4 ";
  shell(run + "--optimizer @matrix-free --iterations 20 --out a");
  shell(run + "--optimizer @matrix-free --iterations 30 --out b");
  const Finished result =
      shell.expect("./isoline compare a b", {.exit_code = 2, .out = {"with another budget"}});
  EXPECT_TRUE(result.out.starts_with("Comparison: worse: NEW lacks ")) << result.out;
  EXPECT_FALSE(contains(result.out, "Only in NEW")) << "the same cells are not listed twice";
  EXPECT_LE(count_lines(result.out), 30U) << result.out;
}

// A program with its own catalog has every verb, and its records name its own repository.

const std::string kOwn = OWN_BINARY;

class OwnProgram : public testing::Test {
 protected:
  Json only_record(const char* out) const {
    for (const auto& entry : std::filesystem::directory_iterator(shell.folder() / out / "runs"))
      return read_json(entry.path());
    return nullptr;
  }
  Shell shell;
};

TEST_F(OwnProgram, ListsDescribesAndChecksWhatOnlyItHas) {
  shell.expect(kOwn + " describe problems --names", {.out = {"twist\n"}});
  EXPECT_FALSE(contains(shell("./isoline describe problems --names").out, "twist\n"));
  shell.expect(kOwn + " describe twist", {.out = {"Twist"}});
  shell.expect(kOwn + " check twist");
}

TEST_F(OwnProgram, ItsRecordsNameItsCommandAndItsCommit) {
  shell.expect(kOwn + " run --problem twist --optimizer newton --out out --quiet");
  const Json provenance = only_record("out").at("provenance");
  EXPECT_EQ(provenance.at("commit"), "0f1e2d3c4b5a");
  EXPECT_EQ(provenance.at("dirty"), true);
  EXPECT_EQ(provenance.at("run").at("command"),
            "isoline_own run --problem twist --optimizer newton --out out --quiet");
  shell("./isoline run --problem square --optimizer newton --out plain --quiet --no-report");
  EXPECT_EQ(provenance.at("isoline_commit"), only_record("plain")["provenance"]["commit"]);
  shell.expect("./isoline validate out");
}

TEST_F(OwnProgram, MistakesAreSaidInItsName) {
  const Finished result = shell.expect(kOwn + " rnu", {.exit_code = 1});
  EXPECT_TRUE(result.err.starts_with("isoline_own: ")) << result.err;
}

TEST_F(OwnProgram, ACheckOfWhatThrowsSaysWhatWasThrown) {
  for (const char* check : {" check thrower", " check thrower --json"})
    shell.expect(kOwn + check, {.exit_code = 2, .out = {"it's on purpose"}});
}

}  // namespace
}  // namespace isoline::benchmarks
