// Writes all formats of a report into a folder, several at a time.
#include "reports/report.h"

#include "core/files.h"
#include "core/threads.h"

namespace isoline::reports {

void write_report(const Document& document, const std::filesystem::path& out) {
  std::filesystem::create_directories(out);
  share(std::size(kFormats),
        [&](std::size_t i) { write_text(out / kFormats[i].file, kFormats[i].text(document)); });
}

}  // namespace isoline::reports
