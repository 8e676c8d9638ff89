// Fields of a run stand beside its record, change nothing of it, and stay with it where it goes.
#include <nlohmann/json.hpp>

#include "benchmarks/merge/merge.h"
#include "benchmarks/merge/record_union.h"
#include "benchmarks/run/store.h"
#include "core/decompose.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"
#include "core/records/npy.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/matrix.h"
#include "tests/benchmarks/pieces.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

std::vector<Request> requests_of(const std::string& problem, const std::string& optimizer,
                                 std::uint64_t seeds = 1, std::int64_t iterations = 40) {
  MatrixBlock block{.problems = {problem},
                    .optimizers = {optimizer},
                    .budget = {.iterations = iterations, .target = 0}};
  block.seeds = parse_seeds(std::to_string(seeds), 100);
  const Suite suite{.name = "mine", .title = "", .blocks = {block}};
  return expand(catalog(), suite, {});
}

fs::path path_in(const fs::path& folder, const Record& record) {
  return folder / "runs" / record.file_name();
}

// The fields of a record with their numbers.
FieldFrames fields_in(const fs::path& folder, const Record& record) {
  FieldFrames fields = record.fields.value();
  read_field_numbers(fields, field_path(path_in(folder, record)));
  return fields;
}

// A run of these requests in a folder of its own.
class Folder {
 public:
  explicit Folder(const std::vector<Request>& requests, const RunOptions& options = {.jobs = 2}) {
    run(requests, options);
  }
  void run(const std::vector<Request>& requests, const RunOptions& options) {
    Store store(path());
    run_all(catalog(), requests, store, options);
    records.clear();
    for (const Request& request : requests) records.push_back(store.find(request).value());
  }
  const fs::path& path() const { return folder_.path(); }
  fs::path file(std::size_t i = 0) const { return field_path(path_in(path(), records[i])); }

  std::vector<Record> records;

 private:
  TemporaryFolder folder_;
};

TEST(Fields, OfAGridProblemStandBesideItsRecord) {
  const std::vector<Request> requests = requests_of("poisson[N=8]", "gd[rate=0.1]");
  const Folder done(requests);
  const Record& record = done.records[0];
  const FieldFrames fields = fields_in(done.path(), record);
  EXPECT_EQ(fields.shape, (std::vector<Index>{8, 8, 8}));
  EXPECT_EQ(fields.iterations.size(), 6U);
  EXPECT_EQ(fields.iterations.front(), 0);
  EXPECT_EQ(fields.iterations.back(), record.summary.iterations);
  for (const std::int64_t iteration : fields.iterations)
    EXPECT_EQ(std::ranges::count(record.curve.iteration, iteration), 1) << iteration;
  const Problem problem = make_problem(catalog(), requests[0].problem, 0);
  const Matrix truth = problem.truth().value();
  // Row by row in the file, column by column in the problem.
  for (Index i = 0; i < 8; ++i)
    for (Index j = 0; j < 8; ++j) {
      const auto at = static_cast<std::size_t>(i * 8 + j);
      EXPECT_EQ(fields.target()[at], static_cast<float>(problem.target()(j * 8 + i, 0)));
      EXPECT_EQ(fields.truth()[at], static_cast<float>(truth(j * 8 + i, 0)));
      EXPECT_EQ(fields.x(0)[at], 0) << "the standard start";
    }
}

// ‖x − x*‖ of each frame is what the curve says at its iteration.
TEST(Fields, AreTheXThatTheCurveJudges) {
  for (const char* problem : {"poisson[N=8]", "heat[N=16]"}) {
    const Folder done(requests_of(problem, "adam[rate=0.1]"));
    const Record& record = done.records[0];
    const FieldFrames fields = fields_in(done.path(), record);
    for (std::size_t f = 0; f < fields.iterations.size(); ++f) {
      Real sum = 0;
      for (std::size_t i = 0; i < fields.truth().size(); ++i)
        sum += std::pow(Real{fields.x(f)[i]} - Real{fields.truth()[i]}, 2);
      const auto at = std::ranges::find(record.curve.iteration, fields.iterations[f]);
      const auto place = static_cast<std::size_t>(at - record.curve.iteration.begin());
      EXPECT_NEAR(std::sqrt(sum), record.curve.x_error.at(place), 1e-5 * std::sqrt(sum))
          << problem << " at " << fields.iterations[f];  // single precision of 256 numbers
    }
  }
}

TEST(Fields, OfALearnedProblemAreOfTheFirstSampleOfItsValidation) {
  const std::vector<Request> requests =
      requests_of("poisson[mode=learn,N=16,batch=2]", "adam", 1, 3);
  const Folder done(requests);
  const FieldFrames fields = fields_in(done.path(), done.records[0]);
  EXPECT_EQ(fields.iterations, (std::vector<std::int64_t>{0, 1, 2, 3}));
  EXPECT_FALSE(done.records[0].exhibit) << "one place for one thing";
  const Problem problem = make_problem(catalog(), requests[0].problem, 0);
  problems::Batch validation;
  problem.draw_validation(validation);
  EXPECT_EQ(fields.truth()[1], static_cast<float>(validation.truth(16, 0)));
  EXPECT_EQ(fields.target()[1], static_cast<float>(validation.target(16, 0)));
}

TEST(Fields, OfOtherSeedsAreKeptWhereTheyAreAskedFor) {
  const std::vector<Request> requests = requests_of("heat[N=8]", "gd", 2);
  const Folder few(requests), all(requests, {.jobs = 2, .keeps_fields = true});
  EXPECT_TRUE(few.records[0].fields && all.records[0].fields && all.records[1].fields);
  EXPECT_FALSE(few.records[1].fields);
  EXPECT_FALSE(fs::exists(few.file(1)));
  EXPECT_TRUE(same_result(few.records[1], all.records[1])) << "what is kept is no result";
}

TEST(Fields, OfALargeGridOrOfNoGridAreNone) {
  for (const char* problem : {"poisson[N=129]", "rosenbrock"}) {
    const Folder done(requests_of(problem, "gd", 1, 2));
    EXPECT_FALSE(done.records[0].fields) << problem;
    EXPECT_FALSE(to_json(done.records[0]).contains("fields")) << problem;
    EXPECT_FALSE(fs::exists(done.file())) << problem;
  }
}

// --- they change nothing

// x ↦ 2x on 2×2 cells, declared as a field or not.
class Twice final : public problems::Physics {
 public:
  Index inputs() const override { return 4; }
  Index outputs() const override { return 4; }
  void forward(BatchRef x, BatchRef, BatchOut y, Workspace&) const override { y = 2 * x; }
  void pushforward(BatchRef v, BatchOut Jv, Workspace&) const override { Jv = 2 * v; }
  void pullback(BatchRef u, BatchOut JTu, Workspace&) const override { JTu = 2 * u; }
};

TEST(Fields, ThatAreKeptLeaveTheTraceAsItIsWithoutThem) {
  std::vector<Json> records;
  for (const bool is_field : {false, true}) {
    Catalog mine = builtin_catalog();
    mine.problems.add({.name = "twice",
                       .title = "Twice",
                       .formula = "2x",
                       .source = "a test",
                       .make = [is_field](const OptionValues&, const problems::Draw&) {
                         problems::ProblemParts parts{.physics = std::make_unique<Twice>(),
                                                      .start = Vector(Vector::LinSpaced(4, 1, 2)),
                                                      .target = Matrix::Constant(4, 1, 0.3),
                                                      .minimum = 0};
                         if (is_field)
                           parts.field = Field{.rows = 2, .columns = 2, .x = {"x"}, .y = {"y"}};
                         return Problem(std::move(parts));
                       }});
    const Request request = named({.problem = complete_problem(mine, "twice", {}),
                                   .optimizer = complete_optimizer(mine, "adam", {}),
                                   .budget = {.iterations = 300, .target = 0}});
    const Record record = executed(mine, request);
    EXPECT_EQ(record.fields.has_value(), is_field);
    records.push_back(without_timings(to_json(record)));
  }
  EXPECT_EQ(records[0], records[1]);
}

TEST(Fields, OfARunThatWasStoppedAndGoneOnAreThoseOfOneThatWasNot) {
  const Request request = requests_of("poisson[mode=learn,N=16,batch=2]", "adam", 1, 12).at(0);
  const auto whole = executed(catalog(), request).fields;
  ASSERT_TRUE(whole);
  EXPECT_EQ(executed_in_pieces(catalog(), request).fields, whole);
}

// --- they stay with their record

TEST(Fields, OfARecordThatIsTimedAgainWithoutThemAreKept) {
  const std::vector<Request> requests = requests_of("heat[N=8]", "gd", 2);
  Folder folder(requests, {.jobs = 2, .keeps_fields = true});
  folder.run(requests, {.jobs = 2, .repeat = 2});
  EXPECT_EQ(folder.records[1].repeat_wall_seconds.size(), 2U);
  EXPECT_EQ(fields_in(folder.path(), folder.records[1]).shape[1], 8);
}

TEST(Fields, OfARecordThatIsMadeAnewWithoutThemAreGone) {
  const std::vector<Request> requests = requests_of("heat[N=8]", "gd", 2);
  Folder folder(requests, {.jobs = 2, .keeps_fields = true});
  ASSERT_TRUE(fs::exists(folder.file(1)));
  folder.run(requests, {.jobs = 2, .force = true});
  EXPECT_FALSE(folder.records[1].fields);
  EXPECT_FALSE(fs::exists(folder.file(1)));
}

TEST(Fields, AreMergedWithTheRecordThatHasThem) {
  const std::vector<Request> requests = requests_of("heat[N=8]", "gd", 2);
  const Folder few(requests), all(requests, {.jobs = 2, .keeps_fields = true});
  const TemporaryFolder place;
  for (const auto& [name, folders] : std::map<std::string, std::vector<fs::path>>{
           {"a", {few.path(), all.path()}}, {"b", {all.path(), few.path()}}}) {
    const MergeOutcome outcome = merge_folders(folders, place.path() / name);
    EXPECT_TRUE(outcome.conflicts.empty()) << name;
    for (const Record& record : all.records) {
      const fs::path path = path_in(place.path() / name, record);
      EXPECT_EQ(fields_in(place.path() / name, read_record(path)), *record.fields);
      EXPECT_EQ(fields_violation(read_json(path), path), "");
    }
  }
}

TEST(Fields, ThatAreMissingOrDamagedAreNamedByTheirRecord) {
  const Folder done(requests_of("heat[N=8]", "gd"));
  const fs::path path = path_in(done.path(), done.records[0]);
  EXPECT_EQ(fields_violation(read_json(path), path), "");
  write_text(done.file(), "damaged");
  EXPECT_NE(fields_violation(read_json(path), path).find("is not the file of fields"),
            std::string::npos);
  fs::remove(done.file());
  EXPECT_NE(fields_violation(read_json(path), path).find("cannot be read"), std::string::npos);
  Json record = read_json(path);
  record["fields"]["shape"] = {8, 8};
  EXPECT_NE(fields_violation(record, path).find("shape"), std::string::npos);
}

TEST(Fields, ThatDifferMakeResultsDiffer) {
  const Folder done(requests_of("heat[N=8]", "gd"));
  Record other = done.records[0], without = done.records[0];
  other.fields->digest = std::string(16, 'f');
  without.fields.reset();
  EXPECT_FALSE(same_result(done.records[0], other));
  EXPECT_EQ(compare_results(done.records[0], other).difference.substr(0, 8), "fields: ");
  EXPECT_TRUE(same_result(done.records[0], without));
  EXPECT_EQ(compare_results(done.records[0], without).difference, "");
}

// --- Singular values of J along a run: those of the J that its steps see, kept where they are
// asked for, and no part of its result.

Request request_of(const std::string& problem, const std::string& optimizer,
                   std::int64_t iterations) {
  return cell_of(problem, optimizer, {.iterations = iterations, .target = 0});
}

// Of the J of the batch at θ, by the thin SVD.
std::vector<Real> singular_values_at(const Problem& problem, const Vector& theta) {
  problems::Point at;
  Matrix J;
  Svd svd;
  problem.forward(theta, problem.batch(), at);
  problem.jacobian(J, at);
  EXPECT_TRUE(thin_svd(J, svd));
  return {svd.sigma.begin(), svd.sigma.end()};
}

class Spectra : public testing::Test {
 protected:
  Record run(const Request& request, const RunOptions& options) {
    Store store(folder_.path());
    outcome = run_all(catalog(), {request}, store, options);
    return store.find(request).value();
  }

  Outcome outcome;

 private:
  TemporaryFolder folder_;
};

TEST_F(Spectra, AreThoseOfTheJacobianAtPowersOfTwoAndTheLast) {
  const Request request = request_of("rosenbrock", "gd[rate=1e-4]", 11);
  const Record record = run(request, {.jobs = 1, .keeps_spectra = true});
  ASSERT_TRUE(record.spectrum);
  EXPECT_EQ(record.spectrum->iterations, (std::vector<std::int64_t>{0, 1, 2, 4, 8, 11}));
  const Problem problem = make_problem(catalog(), request.problem, 0);
  const std::vector<Real> first = singular_values_at(problem, problem.start());
  ASSERT_EQ(record.spectrum->sigma.front().size(), first.size());
  for (std::size_t i = 0; i < first.size(); ++i)
    EXPECT_NEAR(record.spectrum->sigma.front()[i], first[i], 1e-13 * first[0]);
  EXPECT_NE(record.spectrum->sigma.front(), record.spectrum->sigma.back()) << "J is not constant";
}

// After 100 iterations only some are kept; none is kept for its spectrum alone.
TEST_F(Spectra, OfLongRunsStandAtKeptIterations) {
  const Record record =
      run(request_of("rosenbrock", "gd[rate=1e-4]", 300), {.jobs = 1, .keeps_spectra = true});
  const std::vector<std::int64_t>& at = record.spectrum.value().iterations;
  for (const std::int64_t iteration : at)
    EXPECT_EQ(std::ranges::count(record.curve.iteration, iteration), 1) << iteration;
  EXPECT_EQ(at.back(), record.summary.iterations);
  EXPECT_GE(at.at(8), 128);
}

TEST_F(Spectra, OfALearnedProblemAreOfTheBatchOfTheStep) {
  const Request request = request_of("linear-chain[mode=learn,batch=2]", "adam", 3);
  const Record record = run(request, {.jobs = 1, .keeps_spectra = true});
  const Problem problem = make_problem(catalog(), request.problem, 0);
  const std::vector<Real> first = singular_values_at(problem, problem.start());
  const Spectrum& spectrum = record.spectrum.value();
  EXPECT_EQ(spectrum.iterations, (std::vector<std::int64_t>{0, 1, 2, 3}));
  for (std::size_t i = 0; i < first.size(); ++i)
    EXPECT_NEAR(spectrum.sigma.front().at(i), first[i], 1e-13 * first[0]);
}

TEST_F(Spectra, AreNoPartOfTheResult) {
  const Request request = request_of("linear-chain[mode=learn,batch=2]", "adam", 20);
  const Record without = run(request, {.jobs = 1});
  EXPECT_FALSE(without.spectrum);
  const Record with = run(request, {.jobs = 1, .keeps_spectra = true});
  ASSERT_TRUE(with.spectrum) << "a record without them is made anew";
  EXPECT_TRUE(same_result(without, with));
  Record other = with;
  other.spectrum->sigma[1][0] *= 1 + 1e-15;
  EXPECT_FALSE(same_result(with, other)) << "of two that both keep them they are compared";
}

TEST_F(Spectra, OfARecordThatHasThemAreNotMadeAgain) {
  const Request request = request_of("rosenbrock", "gd[rate=1e-4]", 5);
  run(request, {.jobs = 1, .keeps_spectra = true});
  run(request, {.jobs = 1, .keeps_spectra = true});
  EXPECT_EQ(outcome.reused, 1);
  EXPECT_TRUE(run(request, {.jobs = 1, .repeat = 2}).spectrum) << "timed again without them";
}

TEST_F(Spectra, AreMergedWithTheRecordThatHasThem) {
  const Request request = request_of("rosenbrock", "gd[rate=1e-4]", 5);
  const TemporaryFolder a, b, place;
  for (const auto& [folder, keeps] : {std::pair(&a, false), {&b, true}}) {
    Store store(folder->path());
    run_all(catalog(), {request}, store, {.jobs = 1, .keeps_spectra = keeps});
  }
  const auto name = Store(b.path()).find(request).value().file_name();
  for (const auto& folders : {std::vector{a.path(), b.path()}, {b.path(), a.path()}}) {
    const auto out = place.path() / folders[0].filename();
    EXPECT_TRUE(merge_folders(folders, out).conflicts.empty());
    EXPECT_TRUE(read_record(out / "runs" / name).spectrum);
  }
}

// There is nothing to keep, and the cell counts as done.
TEST_F(Spectra, OfAJacobianThatIsTooLargeAreNone) {
  const Request request = request_of("heat[N=64]", "gd", 2);
  ASSERT_GT(make_problem(catalog(), request.problem, 0).residuals(), Trace::Spectra::kValues);
  EXPECT_TRUE(run(request, {.jobs = 1, .keeps_spectra = true}).spectrum.value().iterations.empty());
  run(request, {.jobs = 1, .keeps_spectra = true});
  EXPECT_EQ(outcome.reused, 1);
}

TEST_F(Spectra, OfARunThatWasStoppedAndGoneOnAreThoseOfOneThatWasNot) {
  const Request request = request_of("linear-chain[mode=learn,batch=2]", "adam", 9);
  const auto whole = executed(catalog(), request, {}, true).spectrum;
  ASSERT_EQ(whole.value().iterations, (std::vector<std::int64_t>{0, 1, 2, 4, 8, 9}));
  EXPECT_EQ(executed_in_pieces(catalog(), request, true).spectrum, whole);
}

}  // namespace
}  // namespace isoline::benchmarks
