#include "harness/bench/facts/cell.h"

namespace pt {

void from_json(const Json& json, CellStatus& status) {
    if (json != "ok" && json != "failed") {
        throw WrongFact(fmt::format("a status {}", describe(json)));
    }
    status = json == "ok" ? CellStatus::ok : CellStatus::failed;
}

std::string ConvergenceFacts::reference_hash() const {
    const auto hash = reference.find("hash");
    return hash != reference.end() && hash->is_string() ? hash->get<std::string>() : "";
}

}  // namespace pt
