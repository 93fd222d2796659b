#include "harness/ranks/mpi.h"

#include <algorithm>
#include <numeric>

#include <mpi.h>
#include <time.h>

namespace pt::mpi {

namespace {

int my_rank = 0;
int rank_count = 1;

// Sleeps until an MPI request is done, since MPI's own waits poll; the delay of 0.1 ms is small and never timed.
void wait_asleep(MPI_Request request) {
    for (int is_done = 0;;) {
        MPI_Test(&request, &is_done, MPI_STATUS_IGNORE);
        if (is_done != 0) {
            return;
        }
        const timespec pause{.tv_sec = 0, .tv_nsec = 50'000};
        nanosleep(&pause, nullptr);
    }
}

}  // namespace

bool is_built() { return true; }

Ranks start() {
    MPI_Init(nullptr, nullptr);
    MPI_Comm_rank(MPI_COMM_WORLD, &my_rank);
    MPI_Comm_size(MPI_COMM_WORLD, &rank_count);
    return {.rank = my_rank, .count = rank_count};
}

void finish() { MPI_Finalize(); }

std::string broadcast(const std::string& text) {
    MPI_Request request = MPI_REQUEST_NULL;
    std::uint64_t size = text.size();
    MPI_Ibcast(&size, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD, &request);
    wait_asleep(request);
    std::string received = my_rank == 0 ? text : std::string(size, ' ');
    MPI_Ibcast(received.data(), static_cast<int>(size), MPI_CHAR, 0, MPI_COMM_WORLD, &request);
    wait_asleep(request);
    return received;
}

std::vector<std::string> gather(const std::string& text) {
    MPI_Request request = MPI_REQUEST_NULL;
    const int size = static_cast<int>(text.size());
    std::vector<int> sizes(static_cast<std::size_t>(rank_count)), starts(sizes.size());
    MPI_Igather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, 0, MPI_COMM_WORLD, &request);
    wait_asleep(request);
    std::exclusive_scan(sizes.begin(), sizes.end(), starts.begin(), 0);
    std::string all(static_cast<std::size_t>(starts.back() + sizes.back()), ' ');
    MPI_Igatherv(text.data(), size, MPI_CHAR, all.data(), sizes.data(), starts.data(), MPI_CHAR, 0, MPI_COMM_WORLD,
                 &request);
    wait_asleep(request);
    std::vector<std::string> texts;
    for (std::size_t rank = 0; my_rank == 0 && rank < sizes.size(); ++rank) {
        texts.push_back(all.substr(static_cast<std::size_t>(starts[rank]), static_cast<std::size_t>(sizes[rank])));
    }
    return texts;
}

void barrier() { MPI_Barrier(MPI_COMM_WORLD); }

void add_to_rank_0(std::span<std::int64_t> values) {
    constexpr std::size_t most_at_once = std::size_t{1} << 27;  // MPI counts elements in an int
    for (std::size_t done = 0; done < values.size(); done += most_at_once) {
        const std::span<std::int64_t> part = values.subspan(done, std::min(most_at_once, values.size() - done));
        const void* const mine = my_rank == 0 ? MPI_IN_PLACE : part.data();
        MPI_Reduce(mine, part.data(), static_cast<int>(part.size()), MPI_INT64_T, MPI_SUM, 0, MPI_COMM_WORLD);
    }
}

}  // namespace pt::mpi
