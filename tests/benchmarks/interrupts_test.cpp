// A run that is asked to end by its user, by a scheduler or by a closed terminal: in order, and
// once more at once.
#include <fmt/format.h>
#include <sys/wait.h>

#include <fstream>

#include "core/status.h"
#include "tests/benchmarks/hostile_cells.h"
#include "tests/deadline.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

class Interrupts : public HostileCells {
 protected:
  Interrupts() { options.limits = {.hard_seconds = 600, .idle_seconds = 600}; }
  void wait_until_told() const {
    wait_until([] { return told() != 0; });
  }
  // And waits until it is heard: of two that come together one is lost.
  static void press_ctrl_c(pid_t runner) {
    kill(runner, SIGINT);
    const auto is_pending = [=] {
      std::ifstream in(fmt::format("/proc/{}/status", runner));
      for (std::string word; in >> word;)
        if (word == "ShdPnd:") {
          in >> word;
          return (std::stoull(word, nullptr, 16) >> (SIGINT - 1)) % 2 == 1;
        }
      return false;
    };
    wait_until([&] { return !is_pending(); });
  }
  static int status_of(pid_t runner) {
    int status = 0;
    EXPECT_EQ(waitpid(runner, &status, 0), runner);
    return status;
  }
  bool has_record(const Request& request) const {
    for (const auto& entry : fs::directory_iterator(folder.path() / "runs"))
      if (entry.path().filename().string().starts_with(request.cell)) return true;
    return false;
  }
};

TEST_F(Interrupts, ByOneCtrlCFinishWhatRunsAndStartNoMore) {
  const Request running = hostile("linger"), next = hostile("none");
  const pid_t runner = run_apart({running, next});
  wait_until_told();
  press_ctrl_c(runner);
  EXPECT_TRUE(WIFEXITED(status_of(runner)));
  EXPECT_EQ(record_of(running).status, Status::budget);
  EXPECT_FALSE(has_record(next));
}

TEST_F(Interrupts, ByTwoStopWhatRunsAndKeepItsState) {
  const Request running = hostile("sleep");
  const pid_t runner = run_apart({running});
  wait_until_told();
  press_ctrl_c(runner);
  press_ctrl_c(runner);
  EXPECT_TRUE(WIFEXITED(status_of(runner)));
  const Record record = record_of(running);
  EXPECT_EQ(record.status, Status::interrupted) << record.message;
  EXPECT_EQ(record.curve.iteration.size(), 3U) << "what it had come to";
}

TEST_F(Interrupts, ByThreeEndAllAtOnce) {
  const Request running = hostile("spin");  // hears nothing
  const pid_t runner = run_apart({running});
  wait_until_told();
  const pid_t cell = children_of(runner).at(0);
  for (int i = 0; i < 3; ++i) press_ctrl_c(runner);
  const int status = status_of(runner);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), kInterrupted);
  wait_until([=] { return !lives(cell); });  // it is dying
}

TEST_F(Interrupts, ByASchedulerStopWhatRunsAndItGoesOnThere) {
  for (const int signal : {SIGTERM, SIGHUP}) {
    told() = 0;
    const Request running = hostile("linger");
    fs::remove_all(folder.path() / "runs");
    fs::create_directory(folder.path() / "runs");
    const pid_t runner = run_apart({running});
    wait_until_told();
    kill(runner, signal);
    EXPECT_TRUE(WIFEXITED(status_of(runner))) << signal;
    EXPECT_EQ(record_of(running).status, Status::interrupted) << signal;
    EXPECT_TRUE(fs::exists(store.checkpoint_path(running))) << signal;
    run_all(catalog, {running}, store, options);
    EXPECT_EQ(record_of(running).status, Status::budget) << signal;
  }
}

TEST_F(Interrupts, ByCtrlZStopTheCellsTooUntilAllGoOn) {
  const Request running = hostile("linger");
  const pid_t runner = run_apart({running});
  wait_until_told();
  kill(runner, SIGTSTP);
  int status = 0;
  ASSERT_EQ(waitpid(runner, &status, WUNTRACED), runner);
  ASSERT_TRUE(WIFSTOPPED(status));
  const auto seconds_of_cell = [&] {
    return figures_of(children_of(runner).at(0))->processor_seconds;
  };
  const double before = seconds_of_cell();
  usleep(200'000);
  EXPECT_EQ(seconds_of_cell(), before);
  kill(runner, SIGCONT);
  EXPECT_TRUE(WIFEXITED(status_of(runner)));
  EXPECT_EQ(record_of(running).status, Status::budget);
}

}  // namespace
}  // namespace isoline::benchmarks
