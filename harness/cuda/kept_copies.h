// A cache of the most recently used device copies of a study, with lookup in logarithmic time: a scene of 10^4 lamps
// has as many meshes, and each is looked up in each render.
#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <memory>

namespace pt::cuda {

// An LRU cache of copies on a device. Copy::key_of(host) is the key of a host object, copy.bytes() its copy's size.
template <class Copy>
class KeptCopies {
public:
    // Finds the copy of a host object; null if there is none.
    template <class Host>
    std::shared_ptr<const Copy> find(const Host& host) {
        const auto known = by_key_.find(Copy::key_of(host));
        if (known == by_key_.end()) {
            return nullptr;
        }
        entries_.splice(entries_.begin(), entries_, known->second);
        return entries_.front().copy;
    }
    // Copies a host object to the device. Precondition: the cache has no copy of the object.
    template <class Host>
    std::shared_ptr<const Copy> make(const Host& host) {
        const auto copy = std::make_shared<const Copy>(host);
        entries_.push_front({Copy::key_of(host), copy});
        bytes_ += copy->bytes();
        by_key_[entries_.front().key] = entries_.begin();
        return copy;
    }
    void drop_oldest() {
        bytes_ -= entries_.back().copy->bytes();
        by_key_.erase(entries_.back().key);
        entries_.pop_back();
    }
    std::size_t size() const { return entries_.size(); }
    std::size_t bytes() const { return bytes_; }

private:
    using Key = typename Copy::Key;
    struct Entry {
        Key key;
        std::shared_ptr<const Copy> copy;
    };

    std::list<Entry> entries_;
    std::map<Key, typename std::list<Entry>::iterator> by_key_;
    std::size_t bytes_ = 0;
};

}  // namespace pt::cuda
