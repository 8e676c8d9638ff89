// Panels to JSON and back.
#include "core/records/panel.h"

#include <nlohmann/json.hpp>

namespace isoline {

nlohmann::json to_json(const Panel& panel) {
  return {{"title", panel.title},           {"kind", panel.kind},
          {"where", panel.where},           {"over", panel.over},
          {"divided_by", panel.divided_by}, {"quantity", panel.quantity}};
}

Panel panel_from_json(const nlohmann::json& json) {
  return {.title = json.at("title"),
          .kind = json.at("kind"),
          .where = json.at("where"),
          .over = json.at("over"),
          .divided_by = json.at("divided_by"),
          .quantity = json.at("quantity")};
}

}  // namespace isoline
