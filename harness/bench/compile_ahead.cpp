#include "harness/bench/compile_ahead.h"

#include <atomic>
#include <functional>
#include <mutex>
#include <thread>

#include "harness/bench/progress.h"
#include "harness/cuda/backend.h"

namespace pt {

void compile_ahead(const std::vector<CompileTask>& tasks) {
    std::map<std::string, std::function<void()>> programs;
    for (const CompileTask& task : tasks) {
        if (why_not_applicable(task.variant, features_of(*task.scene), Backend::cuda).empty()) {
            cuda::collect_programs(*task.scene, task.variant, programs);
        }
    }
    std::vector<std::pair<std::string, std::function<void()>>> missing(programs.begin(), programs.end());
    if (missing.empty()) {
        return;
    }
    Progress progress("compile", missing.size());
    std::mutex progress_mutex;
    std::atomic<std::size_t> next = 0;
    const auto work = [&] {
        for (std::size_t i = next++; i < missing.size(); i = next++) {
            try {
                missing[i].second();
            } catch (const std::exception&) {  // reported by who needs it
            }
            const std::lock_guard lock(progress_mutex);
            progress.step(missing[i].first);
        }
    };
    std::vector<std::jthread> threads;
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i) {
        threads.emplace_back(work);
    }
}

}  // namespace pt
