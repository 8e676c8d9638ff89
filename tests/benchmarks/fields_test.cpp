// Fields of a run are stored beside its record, do not change it, and are copied with it.

#include "benchmarks/merge/merge.h"
#include "core/decompose.h"
#include "core/files.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/matrix.h"
#include "tests/benchmarks/pieces.h"

namespace isoline::benchmarks {
namespace {

namespace fs = std::filesystem;

std::vector<Request> requests_of(const std::string& problem, const std::string& optimizer,
                                 std::uint64_t seeds = 1, std::int64_t iterations = 40) {
  std::vector<Request> requests;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    Request request = cell_of(problem, optimizer, {.iterations = iterations, .target = 0});
    request.seed = seed;
    requests.push_back(named(std::move(request)));
  }
  return requests;
}

// The fields of a record in a folder, with their numbers.
FieldFrames fields_in(const fs::path& folder, const Record& record) {
  FieldFrames fields = record.fields.value();
  read_field_numbers(fields, field_path(folder / "runs" / record.file_name()));
  return fields;
}

// A run of these requests in a folder of its own.
class Folder {
 public:
  Folder() = default;
  explicit Folder(const std::vector<Request>& requests, const RunOptions& options = {.jobs = 2}) {
    run(requests, options);
  }
  const Record& run(const std::vector<Request>& requests, const RunOptions& options) {
    Store store(path());
    outcome = run_all(catalog(), requests, store, options);
    records.clear();
    for (const Request& request : requests) records.push_back(store.find(request).value());
    return records[0];
  }
  const fs::path& path() const { return folder_.path(); }
  fs::path record_file(std::size_t i = 0) const { return path() / "runs" / records[i].file_name(); }
  fs::path file(std::size_t i = 0) const { return field_path(record_file(i)); }
  FieldFrames fields(std::size_t i = 0) const { return fields_in(path(), records[i]); }

  Outcome outcome;
  std::vector<Record> records;

 private:
  TemporaryFolder folder_;
};

TEST(Fields, OfAGridProblemStandBesideItsRecord) {
  const std::vector<Request> requests = requests_of("poisson[N=8]", "gd[rate=0.1]");
  const Folder done(requests);
  const Record& record = done.records[0];
  const FieldFrames fields = done.fields();
  EXPECT_EQ(fields.shape, (std::vector<Index>{9, 8, 8}));  // y*, x*, six x, and the last y
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
    const FieldFrames fields = done.fields();
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
  const FieldFrames fields = done.fields();
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
TEST(Fields, ThatAreKeptLeaveTheTraceAsItIsWithoutThem) {
  std::vector<Json> records;
  for (const bool is_field : {false, true}) {
    Catalog mine = builtin_catalog();
    mine.problems.add({.name = "twice",
                       .title = "Twice",
                       .formula = "2x",
                       .source = "a test",
                       .make = [is_field](const OptionValues&, const problems::Draw&) {
                         const auto twice = [](VectorRef x) -> Vector { return 2 * x; };
                         const auto J = [](VectorRef) -> Matrix {
                           return 2 * Matrix::Identity(4, 4);
                         };
                         problems::ProblemParts parts{.physics = physics_of(4, 4, twice, J),
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

// --- they stay with their record

TEST(Fields, OfARecordAreKeptWhereItIsTimedAgainWithoutThemAndGoneWhereItIsMadeAgain) {
  const std::vector<Request> requests = requests_of("heat[N=8]", "gd", 2);
  Folder folder(requests, {.jobs = 2, .keeps_fields = true});
  folder.run(requests, {.jobs = 2, .repeat = 2});
  EXPECT_EQ(folder.records[1].repeat_wall_seconds.size(), 2U);
  EXPECT_EQ(folder.fields(1).shape[1], 8);
  ASSERT_TRUE(fs::exists(folder.file(1)));
  folder.run(requests, {.jobs = 2, .force = true});
  EXPECT_FALSE(folder.records[1].fields);
  EXPECT_FALSE(fs::exists(folder.file(1)));
}

TEST(Fields, AndSpectraAreMergedWithTheRecordThatHasThem) {
  const std::vector<Request> requests = requests_of("heat[N=8]", "gd", 2, 5);
  const Folder few(requests),
      all(requests, {.jobs = 2, .keeps_fields = true, .keeps_spectra = true});
  const TemporaryFolder place;
  for (const auto& [name, folders] : std::map<std::string, std::vector<fs::path>>{
           {"a", {few.path(), all.path()}}, {"b", {all.path(), few.path()}}}) {
    const MergeOutcome outcome = merge_folders(folders, place.path() / name);
    EXPECT_TRUE(outcome.conflicts.empty()) << name;
    for (const Record& record : all.records) {
      const fs::path path = place.path() / name / "runs" / record.file_name();
      EXPECT_EQ(fields_in(place.path() / name, read_record(path)), *record.fields);
      EXPECT_EQ(fields_violation(read_json(path), path), "");
      EXPECT_FALSE(read_record(path).spectrum.value().sigma.empty());
    }
  }
}

TEST(Fields, ThatAreMissingOrDamagedAreNamedByTheirRecord) {
  const Folder done(requests_of("heat[N=8]", "gd"));
  const fs::path path = done.record_file();
  EXPECT_EQ(fields_violation(read_json(path), path), "");
  write_text(done.file(), "damaged");
  EXPECT_NE(fields_violation(read_json(path), path).find("the file of fields"), std::string::npos);
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

;

const RunOptions kKeeping{.jobs = 1, .keeps_spectra = true};

TEST(Spectra, AreThoseOfTheJacobianOfTheStepAtPowersOfTwoAndTheLast) {
  for (const auto& [requests, iterations] :
       {std::pair(requests_of("rosenbrock", "gd[rate=1e-4]", 1, 11),
                  std::vector<std::int64_t>{0, 1, 2, 4, 8, 11}),
        {requests_of("linear-chain[mode=learn,batch=2]", "adam", 1, 3), {0, 1, 2, 3}}}) {
    const Spectrum spectrum = Folder().run(requests, kKeeping).spectrum.value();
    EXPECT_EQ(spectrum.iterations, iterations);
    const Problem problem = make_problem(catalog(), requests[0].problem, 0);
    const std::vector<Real> first = singular_values_at(problem, problem.start());
    ASSERT_EQ(spectrum.sigma.front().size(), first.size());
    for (std::size_t i = 0; i < first.size(); ++i)
      EXPECT_NEAR(spectrum.sigma.front()[i], first[i], 1e-13 * first[0]);
    EXPECT_NE(spectrum.sigma.front(), spectrum.sigma.back()) << "J is not constant";
  }
}

// After 100 iterations only some are kept; none is kept for its spectrum alone.
TEST(Spectra, OfLongRunsStandAtKeptIterations) {
  const Folder done(requests_of("rosenbrock", "gd[rate=1e-4]", 1, 300), kKeeping);
  const Record& record = done.records[0];
  const std::vector<std::int64_t>& at = record.spectrum.value().iterations;
  for (const std::int64_t iteration : at)
    EXPECT_EQ(std::ranges::count(record.curve.iteration, iteration), 1) << iteration;
  EXPECT_EQ(at.back(), record.summary.iterations);
  EXPECT_GE(at.at(8), 128);
}

TEST(Spectra, AreNoPartOfTheResultAndAreMadeOnce) {
  const auto requests = requests_of("linear-chain[mode=learn,batch=2]", "adam", 1, 20);
  Folder folder(requests, {.jobs = 1});
  const Record without = folder.records[0], with = folder.run(requests, kKeeping);
  EXPECT_FALSE(without.spectrum);
  ASSERT_TRUE(with.spectrum) << "a record without them is made again";
  EXPECT_TRUE(same_result(without, with));
  Record other = with;
  other.spectrum->sigma[1][0] *= 1 + 1e-15;
  EXPECT_FALSE(same_result(with, other)) << "of two that both keep them they are compared";
  folder.run(requests, kKeeping);
  EXPECT_EQ(folder.outcome.reused, 1);
  EXPECT_TRUE(folder.run(requests, {.jobs = 1, .repeat = 2}).spectrum)
      << "timed again without them";
}

// There is nothing to keep, and the cell counts as done.
TEST(Spectra, OfAJacobianThatIsTooLargeAreNone) {
  const auto requests = requests_of("heat[N=64]", "gd", 1, 2);
  ASSERT_GT(make_problem(catalog(), requests[0].problem, 0).residuals(), 2048)
      << "of the keeper of spectra";
  Folder folder(requests, kKeeping);
  EXPECT_TRUE(folder.records[0].spectrum.value().iterations.empty());
  folder.run(requests, kKeeping);
  EXPECT_EQ(folder.outcome.reused, 1);
}

TEST(Pieces, OfARunThatWasStoppedAndGoneOnHaveTheFieldsAndSpectraOfOneThatWasNot) {
  const Request grid = requests_of("poisson[mode=learn,N=16,batch=2]", "adam", 1, 12).at(0);
  const auto fields = executed(catalog(), grid).fields;
  ASSERT_TRUE(fields);
  EXPECT_EQ(executed_in_pieces(catalog(), grid).fields, fields);
  const Request chain = requests_of("linear-chain[mode=learn,batch=2]", "adam", 1, 9).at(0);
  const auto spectrum = executed(catalog(), chain, {}, true).spectrum;
  ASSERT_EQ(spectrum.value().iterations, (std::vector<std::int64_t>{0, 1, 2, 4, 8, 9}));
  EXPECT_EQ(executed_in_pieces(catalog(), chain, true).spectrum, spectrum);
}

}  // namespace
}  // namespace isoline::benchmarks
