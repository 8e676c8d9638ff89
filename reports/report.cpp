// Writes all formats of a report into a folder, several at a time.
#include "reports/report.h"

#include "core/files.h"
#include "core/text.h"
#include "core/threads.h"

namespace isoline::reports {

void write_report(const Document& document, const std::filesystem::path& out) {
  std::filesystem::create_directories(out);
  share(std::size(kFormats), [&](std::size_t i) {
    const std::string file = kFormats[i].file, text = kFormats[i].text(document);
    // Formats for terminals and editors; a page shows no control characters, and has scripts.
    write_text(out / file, file.ends_with(".html") ? text : printable(text));
  });
}

}  // namespace isoline::reports
