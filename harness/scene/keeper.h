// LRU caches for what takes long to make, such as trees over meshes: a study renders a scene hundreds of times.
#pragma once

#include <chrono>
#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>

#include <unistd.h>

namespace pt {

// Bytes that one LRU cache may keep on a machine with `memory` bytes: an eighth, since several caches share it, but no
// less than 6 GiB and no more than 16, which hold all trees of the suite `accelerators`.
constexpr std::size_t kept_bytes_of(std::size_t memory) {
    constexpr std::size_t least = std::size_t{6} << 30, most = std::size_t{16} << 30;
    return memory / 8 < least ? least : memory / 8 > most ? most : memory / 8;
}

// Most bytes that one Keeper (an LRU cache) holds; beyond this the entry used longest ago is dropped first.
inline const std::size_t most_kept_bytes = kept_bytes_of(static_cast<std::size_t>(::sysconf(_SC_PHYS_PAGES)) *
                                                         static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)));
inline constexpr std::size_t most_kept = 65536;

// An LRU cache. The key must name everything that a value was made from; T::kept_bytes() is the size of a value.
template <class T>
class Keeper {
public:
    template <class Make>
    std::shared_ptr<const T> get(const std::string& key, const Make& make) {
        if (const auto known = by_key_.find(key); known != by_key_.end()) {
            entries_.splice(entries_.begin(), entries_, known->second);
            return known->second->value;
        }
        auto value = std::make_shared<T>(make());
        entries_.push_front({key, value, value->kept_bytes() + key.size()});
        by_key_.emplace(entries_.front().key, entries_.begin());
        bytes_ += entries_.front().bytes;
        while ((bytes_ > most_kept_bytes || entries_.size() > most_kept) && entries_.size() > 1) {
            bytes_ -= entries_.back().bytes;
            by_key_.erase(entries_.back().key);
            entries_.pop_back();
        }
        return value;
    }

private:
    struct Entry {
        std::string key;
        std::shared_ptr<const T> value;
        std::size_t bytes;
    };

    std::list<Entry> entries_;  // cached values, the most recently used first
    std::unordered_map<std::string_view, typename std::list<Entry>::iterator> by_key_;  // keys are views into entries_
    std::size_t bytes_ = 0;
};

inline double milliseconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace pt
