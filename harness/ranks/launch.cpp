#include "harness/ranks/launch.h"

#include <optional>
#include <sstream>
#include <vector>

#include "harness/words.h"

namespace pt {

namespace {

std::optional<int> number_in(const char* text) {
    const std::optional<int> number = text == nullptr ? std::nullopt : parse_number<int>(text);
    return number && *number >= 0 ? number : std::nullopt;
}

// The environment variables of each launcher. Slurm's step variables alone do not count: Slurm sets them for programs
// without MPI too.
constexpr struct {
    const char *rank, *count, *local_rank, *local_count;
} launchers[] = {
    {"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_LOCAL_RANK", "OMPI_COMM_WORLD_LOCAL_SIZE"},
    {"PMI_RANK", "PMI_SIZE", "MPI_LOCALRANKID", "MPI_LOCALNRANKS"},
    {"PMIX_RANK", "SLURM_STEP_NUM_TASKS", "SLURM_LOCALID", "SLURM_NTASKS_PER_NODE"},
};

}  // namespace

Launch launch_from(const std::function<const char*(const char*)>& variable) {
    for (const auto& launcher : launchers) {
        const std::optional<int> rank = number_in(variable(launcher.rank));
        const std::optional<int> count = number_in(variable(launcher.count));
        if (rank && count && *rank < *count) {
            return {.rank = *rank,
                    .count = *count,
                    .local_rank = number_in(variable(launcher.local_rank)).value_or(0),
                    .local_count = number_in(variable(launcher.local_count)).value_or(1)};
        }
    }
    return {};
}

std::string own_gpu(const Launch& launch, const char* visible) {
    if (launch.local_count < 2) {
        return "";
    }
    if (visible == nullptr) {
        return std::to_string(launch.local_rank);
    }
    std::vector<std::string> gpus;
    std::istringstream list(visible);
    for (std::string gpu; std::getline(list, gpu, ',');) {
        gpus.push_back(gpu);
    }
    const bool is_for_all = gpus.size() >= static_cast<std::size_t>(launch.local_count);
    return is_for_all ? gpus.at(static_cast<std::size_t>(launch.local_rank)) : "";
}

}  // namespace pt
