#include "harness/cuda/several_devices.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <optional>
#include <thread>

#include "harness/cuda/accounting.h"
#include "harness/cuda/cell.h"
#include "harness/render/process_clock.h"
#include "variants/cuda/runtime/nccl.h"
#include "variants/cuda/runtime/on_device.h"

namespace pt::cuda {

namespace {

using SteadyClock = std::chrono::steady_clock;

double milliseconds_between(SteadyClock::time_point begin, SteadyClock::time_point end) {
    return std::chrono::duration<double, std::milli>(end - begin).count();
}

// Threads that drive the devices; the caller's thread drives the first one. The threads exist before the clock starts,
// start together, and all end before `run` returns their start time. Waits are busy loops: waking threads is slow.
class DeviceThreads {
public:
    // Runs `work(device)` on a thread for each device. `work` makes the device current and may throw; the exception of
    // the first device that failed is thrown here after all threads have ended.
    template <class Work>
    static SteadyClock::time_point run(std::uint32_t devices, const Work& work) {
        std::atomic<std::uint32_t> ready{0}, done{0};
        std::atomic<bool> is_started{false};
        std::vector<std::exception_ptr> failures(devices);
        const auto guarded = [&](std::uint32_t device) {
            try {
                work(device);
            } catch (...) {
                failures[device] = std::current_exception();
            }
        };
        std::vector<std::jthread> threads;
        for (std::uint32_t device = 1; device < devices; ++device) {
            threads.emplace_back([&, device] {
                (void)cudaSetDevice(static_cast<int>(device));  // cudaSetDevice() is slow, so it precedes timing
                ready += 1;
                while (!is_started) {
                    std::this_thread::yield();
                }
                guarded(device);
                done += 1;
            });
        }
        while (ready + 1 < devices) {
            std::this_thread::yield();
        }
        const SteadyClock::time_point start = SteadyClock::now();
        is_started = true;
        guarded(0);
        while (done + 1 < devices) {
            std::this_thread::yield();
        }
        threads.clear();
        for (const std::exception_ptr& failure : failures) {
            if (failure != nullptr) {
                std::rethrow_exception(failure);
            }
        }
        return start;
    }
};

// A gate that opens when every thread has arrived or given up.
class Gate {
public:
    explicit Gate(std::uint32_t threads) : missing_(threads) {}
    void come() { missing_ -= 1; }
    void give_up() {
        is_given_up_ = true;
        missing_ -= 1;
    }
    bool is_open() const { return missing_ == 0; }
    // Whether every thread has arrived at the gate and none has given up; to be called once the gate is open.
    bool have_all_come() const { return !is_given_up_; }

private:
    std::atomic<std::uint32_t> missing_;
    std::atomic<bool> is_given_up_{false};
};

template <class Real>
class DeviceGroup {
public:
    DeviceGroup(const Scene& scene, const RenderRequest& request, const RenderSettings& settings,
                const KernelChoice& kernel, const FilmView& film)
        : request_(request),
          traits_(traits_of(request.variant, Backend::cuda)),
          film_words_(std::size_t{3} * settings.width * settings.height),
          first_(0) {
        const std::uint32_t used =
            devices_at_work(traits_.partition, traits_.devices.count, request.samples, settings.height);
        const SampleSource source(traits_.partition, used, {request.first_sample, request.samples});
        // Each device allocates memory for the largest number of samples that it renders at once.
        request_.samples = std::min(request.samples, source.most_at_once());
        request_.checkpoints = {};
        request_.on_checkpoint = {};
        for (std::uint32_t device = 0; device < used; ++device) {
            const OnDevice on(static_cast<int>(device));
            cells_.push_back(std::make_unique<RenderCell<Real>>(scene, request_, settings, kernel, film,
                                                                rows_of(traits_.partition, device, used)));
        }
        if (used > 1) {
            connect();
        }
    }
    ~DeviceGroup() {
        for (std::size_t device = 0; device < cells_.size(); ++device) {
            (void)cudaSetDevice(static_cast<int>(device));
            cells_[device].reset();
        }
        (void)cudaSetDevice(0);
    }
    DeviceGroup(const DeviceGroup&) = delete;
    DeviceGroup& operator=(const DeviceGroup&) = delete;

    // Adds the first device's time of learning for roulette to the render's times: one device learns for all.
    void add_learning(RenderResult& result) const { cells_[0]->add_learning(result); }
    // Renders the samples on all devices and adds the times to `result`.
    void run(const SampleRange& samples, RenderResult& result) {
        const auto devices = static_cast<std::uint32_t>(cells_.size());
        SampleSource source(traits_.partition, devices, samples);
        std::vector<double> device_ms(devices);
        std::vector<SteadyClock::time_point> ends(devices);
        const double cpu_start = process_cpu_ms();
        const SteadyClock::time_point start = render_and_sum(source, device_ms, ends);
        const SteadyClock::time_point end = SteadyClock::now();
        const SteadyClock::time_point last = *std::max_element(ends.begin(), ends.end());
        DeviceFacts& facts = result.devices;
        for (std::uint32_t device = 0; device < devices; ++device) {
            facts.own_ms[device] += device_ms[device] > 0 ? milliseconds_between(start, ends[device]) : 0;
        }
        facts.slowest_ms += milliseconds_between(start, last);
        facts.reduce_ms += milliseconds_between(last, end);
        result.wall_ms += milliseconds_between(start, end);
        result.device_ms += *std::max_element(device_ms.begin(), device_ms.end()) + milliseconds_between(last, end);
        result.cpu_ms += process_cpu_ms() - cpu_start;
    }

    void download(Film& film) const {
        FilmFaults faults;
        for (std::size_t device = 0; device < cells_.size(); ++device) {
            const OnDevice on(static_cast<int>(device));
            faults += cells_[device]->faults();
        }
        std::vector<std::int64_t> summed(film_words_);
        PT_CUDA_CHECK(cudaMemcpyAsync(summed.data(), cells_.size() > 1 ? sum_ : cells_[0]->job().film.sums,
                                      summed.size() * sizeof(std::int64_t), cudaMemcpyDeviceToHost, stream_of(0)));
        PT_CUDA_CHECK(cudaStreamSynchronize(stream_of(0)));
        film.set(std::move(summed), faults);
    }

    // Puts the render's counters and the times of its stages, summed over all devices, into `result`.
    void collect(RenderResult& result) {
        cells_[0]->collect_counts(result);
        for (std::size_t device = 1; device < cells_.size(); ++device) {
            const OnDevice on(static_cast<int>(device));
            RenderResult other{.film = Film(1, 1, 1, 1), .work = {}, .stages = {}};
            cells_[device]->collect_counts(other);
            result.work += other.work;
            result.health.add(other.health);
            add_stages(result.stages, other.stages);
            result.cuda.prepare_ms += other.cuda.prepare_ms;
        }
    }

private:
    cudaStream_t stream_of(std::size_t device) const { return cells_[device]->job().stream; }

    // Renders on all devices and returns, once the first device has the sum of their films, the time at which the
    // threads started. The sum is enqueued behind each device's last piece, since launching it after the render would
    // take longer than the sum itself; but only when no device will ask for another piece, since a device in the sum
    // waits for all others, and asking for a piece may wait for all devices.
    SteadyClock::time_point render_and_sum(SampleSource& source, std::vector<double>& device_ms,
                                           std::vector<SteadyClock::time_point>& ends) {
        const auto devices = static_cast<std::uint32_t>(cells_.size());
        Gate gate(devices);
        const auto work = [&](std::uint32_t device) {
            bool has_come = false;
            std::optional<SteadyClock::time_point> end;
            const auto enqueue_sum_behind = [&] {
                has_come = true;
                gate.come();
                while (!gate.is_open()) {
                    if (!end && cells_[device]->has_rendered()) {
                        end = SteadyClock::now();
                    }
                    std::this_thread::yield();
                }
                if (gate.have_all_come()) {
                    enqueue_sum(device);
                }
            };
            try {
                PT_CUDA_CHECK(cudaSetDevice(static_cast<int>(device)));
                device_ms[device] = cells_[device]->run_pieces([&] { return source.next(device); }, enqueue_sum_behind);
            } catch (...) {
                if (!has_come) {
                    gate.give_up();
                }
                throw;
            }
            ends[device] = end.value_or(SteadyClock::now());
        };
        try {
            const SteadyClock::time_point start = DeviceThreads::run(devices, work);
            wait_for_sum();
            return start;
        } catch (...) {
            disconnect_devices();  // else devices would wait for the failed one to join the sum of the films
            throw;
        }
    }

    // Waits until the first device has the sum, and throws if any device has failed; cudaStreamSynchronize on the first
    // device would not notice failures of others.
    void wait_for_sum() {
        while (!is_done(0)) {
            for (std::size_t device = 1; device < cells_.size(); ++device) {
                (void)is_done(device);
            }
            std::this_thread::yield();
        }
    }

    bool is_done(std::size_t device) const { return is_ready(cudaStreamQuery(stream_of(device))); }

    // Prepares the sum of the films: connects the devices, and allocates and clears the sum's memory.
    void connect() {
        memory_ = std::make_unique<Arena>(film_words_ * sizeof(std::int64_t));
        sum_ = memory_->take<std::int64_t>(film_words_);
        clear(sum_, film_words_ * sizeof(std::int64_t), stream_of(0));
        std::vector<Addend> addends;
        for (std::size_t device = 0; device < cells_.size(); ++device) {
            addends.push_back(addend_of(device));
        }
        connect_devices(addends, sum_, film_words_);
        for (std::size_t device = 0; device < cells_.size(); ++device) {
            PT_CUDA_CHECK(cudaStreamSynchronize(stream_of(device)));
        }
    }

    Addend addend_of(std::size_t device) const {
        return {device, cells_.size(), stream_of(device), cells_[device]->job().film.sums};
    }

    void enqueue_sum(std::size_t device) {
        if (cells_.size() > 1) {
            add_to_first(addend_of(device), sum_, film_words_);
        }
    }

    // Bounds are of the paths of one device, so they do not stand beside sums over several.
    static void add_stages(StageTimes& into, const StageTimes& from) {
        into.memory_bounds.clear();
        for (const auto& [stage, milliseconds] : from.milliseconds) {
            into.add(stage, milliseconds);
        }
        for (std::size_t segment = 0; segment < from.live_paths.size(); ++segment) {
            into.add_live(segment, from.live_paths[segment]);
        }
    }

    RenderRequest request_;  // what each device is asked to render; `cells_` keep a reference
    VariantTraits traits_;
    std::size_t film_words_;
    OnDevice first_;  // while alive, makes the first device the thread's current one
    std::unique_ptr<Arena> memory_;
    std::int64_t* sum_ = nullptr;  // the sum of the films, on the first device
    std::vector<std::unique_ptr<RenderCell<Real>>> cells_;
};

}  // namespace

template <class Real>
void render_on_devices(const Scene& scene, const RenderRequest& request, const RenderSettings& settings,
                       const KernelChoice& kernel, RenderResult& result) {
    const std::uint32_t asked = traits_of(request.variant, Backend::cuda).devices.count;
    result.devices.count = asked;
    result.devices.own_ms.assign(asked, 0.0);
    DeviceGroup<Real> group(scene, request, settings, kernel, result.film.view());
    group.add_learning(result);
    for (const RenderPart& part : parts_of(request)) {
        group.run({request.first_sample + part.done, part.samples}, result);
        if (is_shown(request)) {
            group.download(result.film);
            report_checkpoint(request, part, result);
        }
    }
    group.download(result.film);
    group.collect(result);
}

template void render_on_devices<float>(const Scene& scene, const RenderRequest& request, const RenderSettings& settings,
                                       const KernelChoice& kernel, RenderResult& result);
template void render_on_devices<double>(const Scene& scene, const RenderRequest& request,
                                        const RenderSettings& settings, const KernelChoice& kernel,
                                        RenderResult& result);

}  // namespace pt::cuda
