#include "harness/bench/shard.h"

#include <algorithm>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "harness/words.h"

namespace pt {

namespace {

// Disjoint sets of cells (union-find); the representative of a group is its first cell.
class Groups {
public:
    explicit Groups(std::size_t size) : parents_(size) { std::iota(parents_.begin(), parents_.end(), 0); }

    std::size_t first_of(std::size_t cell) const {
        while (parents_[cell] != cell) {
            cell = parents_[cell];
        }
        return cell;
    }
    // Merges the group of `cell` with the group of the earlier cell that has the same `key`, if `known` has one.
    void join(std::map<std::string, std::size_t>& known, const std::string& key, std::size_t cell) {
        const std::size_t a = first_of(known.try_emplace(key, cell).first->second);
        const std::size_t b = first_of(cell);
        parents_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::size_t> parents_;
};

// The part of a cell's name after the variant, without "/checkpoints:..": equal with and without checkpoints.
std::string setting_of(const Cell& cell) {
    const std::string setting = setting_in(cell.name);
    return setting.substr(0, setting.find("/checkpoints:"));
}

std::uint64_t work_of(const Plan& plan, const std::vector<std::size_t>& group) {
    std::uint64_t work = 0;
    for (const std::size_t position : group) {
        const Cell& cell = plan.cells[position];
        work += std::uint64_t{cell.settings.width} * cell.settings.height * cell.spp;
    }
    return work;
}

}  // namespace

std::string Shard::name() const { return fmt::format("{}/{}", index, count); }

Shard parse_shard(const std::string& text) {
    const auto numbers = parse_pair(text, '/');
    if (!numbers || numbers->first < 1 || numbers->first > numbers->second) {
        throw InputError("--shard", "argument", "\"" + text + "\"", "I/N, the I-th of N parts, I from 1 to N");
    }
    return {numbers->first, numbers->second};
}

std::vector<std::vector<std::size_t>> groups_of(const Plan& plan) {
    Groups groups(plan.cells.size());
    std::map<std::string, std::size_t> by_setting, by_reference;
    for (std::size_t i = 0; i < plan.cells.size(); ++i) {
        groups.join(by_setting, setting_of(plan.cells[i]), i);
        if (plan.cells[i].convergence) {
            groups.join(by_reference, plan.cells[i].convergence->reference.name(), i);
        }
    }
    std::map<std::size_t, std::vector<std::size_t>> by_first;
    for (std::size_t i = 0; i < plan.cells.size(); ++i) {
        by_first[groups.first_of(i)].push_back(i);
    }
    std::vector<std::vector<std::size_t>> found;
    for (auto& [first, group] : by_first) {
        found.push_back(std::move(group));
    }
    return found;
}

std::vector<std::size_t> positions_of(const Plan& plan, const Shard& shard) {
    std::vector<std::vector<std::size_t>> groups = groups_of(plan);
    if (!shard.is_whole() && shard.count > groups.size()) {
        throw InputError(
            "--shard", "argument", "\"" + shard.name() + "\"",
            fmt::format("at most {} parts of this run: cells of one scene and setting stay together", groups.size()));
    }
    std::stable_sort(groups.begin(), groups.end(),
                     [&](const auto& a, const auto& b) { return work_of(plan, a) > work_of(plan, b); });
    std::vector<std::uint64_t> loads(shard.count);
    std::vector<std::size_t> positions;
    for (const std::vector<std::size_t>& group : groups) {
        const auto least = std::min_element(loads.begin(), loads.end());
        *least += work_of(plan, group);
        if (least - loads.begin() + 1 == shard.index) {
            positions.insert(positions.end(), group.begin(), group.end());
        }
    }
    std::sort(positions.begin(), positions.end());
    return positions;
}

Plan part_of(const Plan& plan, const std::vector<std::size_t>& positions) {
    Plan part{{}, plan.not_applicable};
    for (const std::size_t position : positions) {
        part.cells.push_back(plan.cells[position]);
    }
    return part;
}

}  // namespace pt
