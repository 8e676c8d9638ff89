// The report of a study: one page for people, and the same figures as Markdown, LaTeX, CSV, JSON.
// Folders from the ground up, above core/results; each may include those above it in this list.
//
// - sections/: the table of runs to sections of sentences, tables and plots, one file a topic, with
//   the sentences of words/; `Document`.
// - formats/: a document to text, one file a format.
// - page/: a document to the page, its charts' data, its style and its scripts.
// - compare/: the gate: what changed from one set of results to another; baselines.
//
// A new format is a file of formats/, with its declaration and its row in formats/formats.h.
#pragma once

#include <malloc.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <ranges>
#include <string>
#include <type_traits>

#include "core/files.h"
#include "core/output.h"
#include "core/results/study.h"
#include "core/text.h"
#include "core/threads.h"
#include "reports/formats/formats.h"

namespace isoline::reports {

using namespace results;

// Takes out of a record what no section and no format of a report reads; what claims alone read
// stays in those that they name.
inline void trim_for_report(Record& record, bool is_claimed) {
  const auto drop = [](auto&... all) { ((all = std::remove_reference_t<decltype(all)>()), ...); };
  for (std::optional<Hits>* each : {&record.hits, &record.x_hits}) {
    if (!*each) continue;
    Hits& hits = **each;
    const auto met = static_cast<std::size_t>(std::ranges::count_if(
        hits.iteration, [](std::int64_t iteration) { return iteration >= 0; }));
    const auto shorten = [met](auto&... all) { ((all.resize(met), all.shrink_to_fit()), ...); };
    drop(hits.forwards);
    shorten(hits.target, hits.iteration, hits.work, hits.wall_seconds);
    for (auto& [oracle, column] : hits.counts) shorten(column);
  }
  drop(record.verified, record.found, record.repeat_wall_seconds, record.build_parts,
       record.failures);
  if (!is_claimed) drop(record.curve.gradient_norm, record.curve.step_norm);
}

// Writes every format into the folder, which it makes, several at a time. The formats of an earlier
// report are replaced after the last one is written. The page goes first and comes last: where it
// is, all files belong to it, and no kill leaves files of two reports.
inline void write_report(const Document& document, const std::filesystem::path& out) {
  namespace fs = std::filesystem;
  make_output_folder(out);
  for (const std::string& name : names_in(out))
    if (is_abandoned(out / name)) fs::remove(out / name);
  malloc_trim(0);  // what the sections took and gave back
  const auto beside = [&](const Format& format) { return temporary_of(out / format.file); };
  const auto write = [&](std::size_t i) {
    const std::string file = kFormats[i].file, text = kFormats[i].text(document);
    // Formats for terminals and editors. A page shows no control characters, and has scripts; the
    // fields of CSV, the longest text, are printable already.
    const bool is_safe = file.ends_with(".html") || file.ends_with(".csv");
    write_text(beside(kFormats[i]), is_safe ? text : printable(text));
  };
  try {
    share(std::size(kFormats), write);
  } catch (...) {
    std::error_code unknown;
    for (const Format& format : kFormats) fs::remove(beside(format), unknown);
    throw;
  }
  for (const Format& format : kFormats) fs::remove(out / format.file);
  for (const Format& format : std::views::reverse(kFormats))
    fs::rename(beside(format), out / format.file);
}

}  // namespace isoline::reports
