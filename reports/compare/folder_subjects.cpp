// Makes a subject of each record as it is read, and forgets the record.
#include "reports/compare/folder_subjects.h"

#include <filesystem>
#include <memory>

#include "core/errors.h"
#include "reports/read/newest.h"
#include "reports/read/result_files.h"

namespace isoline::reports {
namespace {

// What is left of a record.
struct Reading {
  RunMark mark;  // without a cell where it could not be read
  Subject subject;
  Real best_loss = kNever;
  std::unique_ptr<const Record> figures;  // while f_L, which its figures need, is not known
};

// A record with what its figures are made of, and no more.
std::unique_ptr<const Record> figures_of(Record record) {
  auto figures = std::make_unique<Record>();
  figures->request.problem.spec = record.request.problem.spec;
  figures->request.seed = record.request.seed;
  figures->status = record.status;
  figures->summary = record.summary;
  figures->scale = record.scale;
  figures->x_scale = record.x_scale;
  figures->x_floor = record.x_floor;
  figures->hits = std::move(record.hits);
  figures->curve.work = std::move(record.curve.work);
  figures->curve.loss = std::move(record.curve.loss);
  figures->curve.x_error = std::move(record.curve.x_error);
  return figures;
}

Reading read(const std::string& file, const std::optional<BestKnown>& reference) {
  static const BestKnown kNone{BestKnown::Minima{}};
  Reading reading;
  try {
    Record record = read_record(file);
    reading.subject = subject_without_figures(record);
    if (record.status != Status::inapplicable) reading.best_loss = record.summary.best_loss;
    reading.mark = mark_of(record);
    if (reference || record.minimum || record.status == Status::inapplicable)
      add_figures(reading.subject, record, reference ? *reference : kNone);
    else
      reading.figures = figures_of(std::move(record));
  } catch (const std::exception&) {
    reading.mark.cell.clear();
  }
  return reading;
}

bool files_are_at_odds(const std::string& a, const std::string& b) {
  return are_at_odds(read_record(a), read_record(b));
}

BestKnown best_of(const std::vector<Reading>& readings, const std::vector<std::size_t>& kept) {
  BestKnown::Minima minima;
  for (const std::size_t i : kept) {
    const RunMark& mark = readings[i].mark;
    Real& least = minima.emplace(std::pair(mark.problem, mark.seed), kNever).first->second;
    if (readings[i].best_loss < least) least = readings[i].best_loss;
  }
  return BestKnown(std::move(minima));
}

}  // namespace

FolderSubjects read_subjects(const std::string& folder, const std::optional<BestKnown>& reference,
                             const Listener& listener) {
  std::error_code unknown;
  require(std::filesystem::is_directory(folder, unknown),
          [&] { return folder + ": no such result folder"; });
  std::vector<Unreadable> unlisted;
  const std::vector<std::string> files = record_files({folder}, unlisted);
  std::vector<Reading> readings(files.size());
  share(
      files.size(), [&](std::size_t i) { readings[i] = read(files[i], reference); }, listener);
  std::vector<RunMark> marks;
  std::size_t unreadable = unlisted.size();
  for (const Reading& reading : readings) {
    marks.push_back(reading.mark);
    unreadable += reading.mark.cell.empty();
  }
  const Newest newest = newest_of(
      marks, [&](std::size_t i, std::size_t j) { return files_are_at_odds(files[i], files[j]); });
  FolderSubjects found{.subjects = std::vector<Subject>(newest.kept.size()),
                       .best = best_of(readings, newest.kept),
                       .unreadable = unreadable,
                       .superseded = newest.superseded};
  share(newest.kept.size(), [&](std::size_t k) {
    Reading& reading = readings[newest.kept[k]];
    if (reading.figures) add_figures(reading.subject, *reading.figures, found.best);
    if (newest.disputed.contains(reading.mark.cell))
      reading.subject.doubt = "two records of this cell and build differ";
    found.subjects[k] = std::move(reading.subject);
  });
  return found;
}

}  // namespace isoline::reports
