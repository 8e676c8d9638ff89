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

#include <filesystem>
#include <string>

#include "core/files.h"
#include "core/text.h"
#include "core/threads.h"
#include "reports/formats/formats.h"

namespace isoline::reports {

using namespace results;

// Writes every format into the folder, which it makes, several at a time.
inline void write_report(const Document& document, const std::filesystem::path& out) {
  std::filesystem::create_directories(out);
  share(std::size(kFormats), [&](std::size_t i) {
    const std::string file = kFormats[i].file, text = kFormats[i].text(document);
    // Formats for terminals and editors; a page shows no control characters, and has scripts.
    write_text(out / file, file.ends_with(".html") ? text : printable(text));
  });
}

}  // namespace isoline::reports
