// Makes the sheets of a plan, each in a process of its own, and measures the prices of its
// problems.
#include <fmt/format.h>

#include <functional>
#include <set>

#include "benchmarks/run/isolated_text.h"
#include "benchmarks/run/prices.h"
#include "benchmarks/run/sheets.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/records/file_text.h"

namespace isoline::benchmarks {
namespace {

constexpr double kSheetSeconds = 30;

// Makes sheets, each in a process of its own: what goes wrong there costs that sheet its figures.
class SheetWriter {
 public:
  SheetWriter(const Catalog& catalog, Store& store) : catalog_(catalog), store_(store) {}

  void write_problem(const Component& component) {
    if (!known_.insert("problem " + component.spec).second) return;
    Sheet sheet = described_problem(catalog_, component);
    if (replace(sheet, [&] { return problem_sheet(catalog_, component); }))
      sheet.prices = prices_of(component, sheet.file_name());
    write(sheet);
  }

  void write_optimizer(const Component& component) {
    if (!known_.insert("optimizer " + component.spec).second) return;
    Sheet sheet = described_optimizer(catalog_, component);
    replace(sheet, [&] { return optimizer_sheet(catalog_, component); });
    write(sheet);
  }

 private:
  // By the whole one, where that can be made.
  bool replace(Sheet& sheet, const std::function<Sheet()>& make) {
    const IsolatedText made = isolated_text([&] { return file_text(make()); }, kSheetSeconds);
    std::string reason = made.failure;
    if (made.text) try {
        sheet = sheet_from_text(*made.text, "what it wrote");
        return true;
      } catch (const std::exception& error) {
        reason = error.what();
      }
    store_.remark(fmt::format("the sheet of {} tells no more than the registry does: {}",
                              sheet.spec, reason));
    return false;
  }

  void write(const Sheet& sheet) {
    try {
      store_.write(sheet);
    } catch (const std::exception& error) {
      store_.remark(fmt::format("the sheet of {} is missing: {}", sheet.spec, error.what()));
    }
  }

  std::optional<MeasuredPrices> stored_prices(const std::filesystem::path& file) {
    if (!is_there(file)) return std::nullopt;
    try {
      return sheet_from_text(read_text(file), file.string()).prices;
    } catch (const std::exception& error) {
      store_.set_aside(file, error.what());
      return std::nullopt;
    }
  }

  // Those that the folder has already, where this build measured them on this processor: a run that
  // goes on does not change the report of what is done. The problem is made again: what goes wrong
  // in measuring does not cost the sheet.
  std::optional<MeasuredPrices> prices_of(const Component& component, const std::string& file) {
    const std::string build = prices_build(component);
    auto stored = stored_prices(store_.folder() / "components" / file);
    if (are_ours(stored, build)) return stored;
    const auto measured = [&] {
      Sheet sheet;
      sheet.options_text = "[]";
      sheet.prices = measure_prices(make_problem(catalog_, component, 0), build);
      return file_text(sheet);
    };
    const auto text = isolated_text(measured, kSheetSeconds).text;
    if (text) try {
        return sheet_from_text(*text, "prices of " + component.spec).prices;
      } catch (const UsageError&) {  // declared ones are counted with
      }
    return std::nullopt;
  }

  const Catalog& catalog_;
  Store& store_;
  std::set<std::string> known_;
};

}  // namespace

void write_sheets(const Catalog& catalog, const std::vector<Request>& requests, Store& store) {
  SheetWriter writer(catalog, store);
  for (const Request& request : requests) {
    writer.write_problem(request.problem);
    writer.write_optimizer(request.optimizer);
  }
}

}  // namespace isoline::benchmarks
