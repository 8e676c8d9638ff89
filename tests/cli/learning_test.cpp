// Training and inference on the command line, and their error messages.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/json.h"
#include "core/records/npy.h"
#include "tests/cli/shell.h"

namespace isoline::benchmarks {

namespace {

namespace fs = std::filesystem;

TEST(Train, WritesANetworkThatInfersWhatItLearned) {
  const Shell shell;
  shell.expect("./isoline train 'sine[xi=2]' --optimizer sip --iterations 1500 --out net.json");
  shell.expect("printf 'y1,y2\\n0.3,-0.5\\n-0.2,0.1\\n' > y.csv");
  shell.expect("./isoline solution net.json --input y.csv --out x.npy");
  const NumberArray x = read_npy(shell.folder() / "x.npy");
  EXPECT_EQ(x.shape, (std::vector<Index>{2, 2}));
  // P of the inferred x, with ξ = 2, φ = 45° and γ = 10, is near what was observed.
  const Real half = std::sqrt(0.5), z1 = half * (x.values[0] - x.values[1]);
  EXPECT_NEAR(std::sin(10 * z1 / 2), 0.3, 0.1);
  EXPECT_NEAR(20 * half * (x.values[0] + x.values[1]), -0.5, 0.1);
  const auto as_json = read_text(shell.folder() / "net.json");
  EXPECT_TRUE(contains(as_json, "isoline.network/1"));
}

// What the network is applied to is what it was trained on: the y* of the file give the same x.
TEST(Infer, WritesTheSamplesOfTheTraining) {
  const Shell shell;
  shell.expect(
      "./isoline train 'sine[xi=2,data=5]' --optimizer adam --iterations 9 --out net.json");
  shell.expect("./isoline solution net.json --training-data y.csv --out x.csv");
  EXPECT_EQ(count_lines(read_text(shell.folder() / "y.csv")), 5U);
  shell.expect("./isoline solution net.json --input y.csv --out again.csv");
  EXPECT_EQ(read_text(shell.folder() / "x.csv"), read_text(shell.folder() / "again.csv"));
}

// Levenberg-Marquardt solves each instance alone to rounding, so that no network wins. Against no
// step of gradient descent, the network wins. One that sees other y* fits its few instances, too.
TEST(NetworkOrSolver, CountsTheInstancesThatTheNetworkWins) {
  const Shell shell;
  const Finished done = shell.expect(
      "python3 " ISOLINE_SOURCE_DIR
      "/clients/python/network_or_solver.py 'sine[xi=1]' --instances 4 --steps 400 --training "
      "'adam[rate=1e-2]' --solvers 'levenberg-marquardt,gd[rate=1e-300]'");
  struct Row {
    int network = -1, shuffled = -1, refined = -1;
    double of_network = 0, of_shuffled = 0, of_solver = 0;
  };
  const auto row_of = [&](const std::string& solver) {
    Row row;
    const std::size_t at = done.out.rfind(solver);
    EXPECT_EQ(std::sscanf(done.out.c_str() + at + solver.size(), "%d/4 %d/4 %d/4 %lf %lf %lf",
                          &row.network, &row.shuffled, &row.refined, &row.of_network,
                          &row.of_shuffled, &row.of_solver),
              6)
        << done.out;
    return row;
  };
  const Row newton = row_of("levenberg-marquardt"), nothing = row_of("gd[rate=1e-300]");
  EXPECT_EQ(newton.network, 0);
  EXPECT_LE(newton.of_solver, 1e-25);
  EXPECT_EQ(nothing.network, 4);
  EXPECT_EQ(nothing.refined, 4) << "it ends where the network is";
  EXPECT_NE(nothing.of_network, nothing.of_shuffled);
}

TEST(Train, ContinuesFromANetwork) {
  const Shell shell;
  shell.expect("./isoline train 'sine[xi=2]' --optimizer sip --iterations 300 --out net.json");
  shell.expect(
      "./isoline train 'sine[xi=2]' --from net.json --optimizer 'gd[rate=1e-12]' "
      "--iterations 1 --out more.json");
  const Json first = parse_json(read_text(shell.folder() / "net.json"), "net"),
             more = parse_json(read_text(shell.folder() / "more.json"), "more");
  EXPECT_NEAR(more.at("loss").get<Real>(), first.at("loss").get<Real>(),
              1e-6 * first.at("loss").get<Real>());
  EXPECT_EQ(more.at("iterations"), 1);
  shell.expect("./isoline train 'sine[xi=3]' --from net.json --out x.json",
               {.exit_code = 1, .err = {"net.json is a network of"}});
}

TEST(Train, KeepsTheRunningStatisticsOfBatchNormForPictures) {
  const Shell shell;
  shell.expect(
      "./isoline train 'poisson[N=16,batch=4,network=unet[levels=2]]' --iterations 5 --out n.bin");
  NumberArray pictures{{3, 16, 16}, std::vector<Real>(3 * 256)};
  for (std::size_t i = 0; i < pictures.values.size(); ++i)
    pictures.values[i] = std::sin(0.1 * static_cast<Real>(i));
  write_npy(shell.folder() / "y.npy", pictures);
  shell.expect("./isoline solution n.bin --input y.npy --out x.npy");
  const NumberArray all = read_npy(shell.folder() / "x.npy");
  EXPECT_EQ(all.shape, pictures.shape);
  // Running statistics, so a sample alone gives what it gives among others.
  NumberArray second{{1, 16, 16}, {pictures.values.begin() + 256, pictures.values.begin() + 512}};
  write_npy(shell.folder() / "y.npy", second);
  shell.expect("./isoline solution n.bin --input y.npy --out x.npy");
  const NumberArray alone = read_npy(shell.folder() / "x.npy");
  for (std::size_t i = 0; i < 256; ++i) EXPECT_EQ(alone.values[i], all.values[256 + i]) << i;
}

TEST(Train, MistakesAreOneSentenceAndLeaveNothing) {
  const Shell shell;
  shell.expect("./isoline train sine --iterations 5 --out net.json");
  shell("printf '1,2,3\\n' > wide.csv; printf '1,nan\\n' > holes.csv; printf '1,2\\n' > good.csv");
  for (const auto& [command, sentence] : std::vector<std::pair<std::string, std::string>>{
           {"train 'sine[network=unet]' --out x", "unet"},
           {"train 'poisson[N=20,network=unet]' --out x", "20"},
           {"train 'sine[network=mlp[layers=a-b]]' --out x", "layers"},
           {"train 'sine[network=mpl]' --out x", "did you mean 'mlp'"},
           {"train 'sine[batch=0]' --out x", "batch must be in"},
           {"train sine --optimizer 'adam[rate=-1]' --out x", "rate must be in"},
           {"train sine --optimizer 'sip[network-optimizer=adam[rate=-1]]' --out x",
            "rate must be"},
           {"train 'sine[mode=direct]' --out x", "no network to train"},
           {"train sine --optimizer ceres-lbfgs --out x", "data=N"},
           {"solution net.json --input wide.csv --out x", "takes 2"},
           {"solution net.json --input holes.csv --out x.npy", "'nan' is not "},
           {"solution net.json --input good.csv --out x.txt", ".npy or .csv"},
           {"solution good.csv --input good.csv --out x.npy", "not a trained network"},
           {"solution net.json --out x.npy", "either --input or --training-data"},
           {"solution net.json --training-data y.csv --out x.npy", "data=N"},
           {"solution net.json --input missing.npy --out x.npy", "missing.npy"}}) {
    const Finished result =
        shell.expect("./isoline " + command, {.exit_code = 1, .err = {sentence}});
    EXPECT_EQ(count_lines(result.err), 1U) << command << "\n" << result.err;
    for (const char* file : {"x", "x.npy", "x.txt"})
      EXPECT_FALSE(fs::exists(shell.folder() / file)) << command;
  }
}

// A file of a network, read as JSON and written in another form.
void rewrite(const Shell& shell, const char* name, const std::function<void(Json&)>& change,
             int indent = -1) {
  Json network = read_json(shell.folder() / "net.json");
  change(network);
  write_text(shell.folder() / name, network.dump(indent));
}

TEST(Network, IsReadHoweverItsJsonIsLaidOut) {
  const Shell shell;
  shell.expect("./isoline train sine --iterations 5 --out net.json");
  shell("printf '1,2\n' > y.csv");
  rewrite(shell, "one-line.json", [](Json&) {});
  rewrite(
      shell, "pretty.json", [](Json&) {}, 2);
  write_text(shell.folder() / "blank-lines.json", read_text(shell.folder() / "net.json") + "\n\n");
  shell.expect("./isoline solution net.json --input y.csv --out x.csv");
  for (const std::string name : {"one-line.json", "pretty.json", "blank-lines.json"}) {
    shell.expect("./isoline solution " + name + " --input y.csv --out z.csv");
    EXPECT_EQ(read_text(shell.folder() / "x.csv"), read_text(shell.folder() / "z.csv")) << name;
  }
  shell.expect("./isoline validate net.json pretty.json");
}

TEST(Network, OfSizesThatCannotBeIsRefusedBeforeThereIsRoomForThem) {
  const Shell shell;
  shell.expect("./isoline train sine --iterations 5 --out net.json");
  shell("printf '1,2\n' > y.csv");
  for (const char* size : {"-5", "1000000000000000", "2305843009213693952", "18446744073709551615",
                           "1000000000000000000000000000000", "\"many\""})
    for (const char* name : {"parameters", "statistics"}) {
      rewrite(shell, "x.json", [&](Json& json) { json[name] = parse_json(size, "size"); });
      const Finished refused = shell.expect("./isoline solution x.json --input y.csv --out x.npy",
                                            {.exit_code = 1, .err = {"x.json is not", name}});
      EXPECT_EQ(count_lines(refused.err), 1U) << refused.err;
      for (const char* foreign : {"stoll", "bad_alloc", "max_size", "json.exception"})
        EXPECT_FALSE(contains(refused.err, foreign)) << refused.err;
    }
}

TEST(Network, WithStatisticsOfAnotherNetworkIsRefused) {
  const Shell shell;
  const std::string train =
      "./isoline train 'poisson[N=16,batch=4,network=unet[levels=2]]' --iterations 2 --out ";
  shell.expect(train + "net.json");
  write_npy(shell.folder() / "y.npy", {{1, 16, 16}, std::vector<Real>(256, 0.1)});
  rewrite(shell, "x.json", [](Json& json) {
    json["statistics"] = 1;
    json["mean_statistics"] = {0.5};
  });
  shell.expect("./isoline solution x.json --input y.npy --out x.npy",
               {.exit_code = 1, .err = {"1 statistics, but"}});
}

TEST(Infer, IsEndedAtItsLimitsAndSaysSo) {
  const Shell shell;
  shell.expect("./isoline train sine --iterations 5 --out net.json");
  write_npy(shell.folder() / "y.npy", {{2'000'000, 2}, std::vector<Real>(4'000'000, 0.1)});
  const std::string infer = "./isoline solution net.json --input y.npy --out x.npy ";
  shell.expect(infer + "--time 1ms",
               {.exit_code = 2, .err = {"x.npy was not written", "took more than"}});
#ifndef ISOLINE_SANITIZE  // which the address space is not limited under
  shell.expect(infer + "--memory 16MB",
               {.exit_code = 2, .err = {"x.npy was not written", "out of memory"}});
#endif
  EXPECT_FALSE(fs::exists(shell.folder() / "x.npy"));
  shell.expect(infer);
}

TEST(Train, IsEndedAtItsLimitsLikeACell) {
  const Shell shell;
  shell.expect("./isoline train sine --iterations 1000000000 --time 500ms --out n.json");
  EXPECT_TRUE(fs::exists(shell.folder() / "n.json")) << "what was learned by then is kept";
#ifndef ISOLINE_SANITIZE
  shell.expect(
      "./isoline train 'poisson[N=64,batch=64,network=unet[levels=3]]' --iterations 5 "
      "--memory 16MB --out m.json",
      {.exit_code = 2, .err = {"no network was written: "}});
#endif
  EXPECT_FALSE(fs::exists(shell.folder() / "m.json"));
}

TEST(Train, DoesNotBeginWhatCannotBeWritten) {
  const Shell shell;
  for (const char* out : {"nowhere/net.json", "."}) {
    shell.expect(std::string("./isoline train sine --iterations 1000000000 --out ") + out,
                 {.exit_code = 1, .err = {std::string("cannot write ") + out}});
  }
}

TEST(Network, ThatDoesNotFitLeavesNoFolder) {
  const Shell shell;
  const Finished result = shell.expect(
      "./isoline run --problem 'sine[mode=learn,network=unet]' --optimizer adam --out results/r",
      {.exit_code = 1});
  EXPECT_EQ(count_lines(result.err), 1U) << result.err;
  EXPECT_FALSE(fs::exists(shell.folder() / "results"));
}

}  // namespace
}  // namespace isoline::benchmarks
