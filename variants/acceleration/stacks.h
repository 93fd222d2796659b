// Stacks of a walk (walk.h). Where their entries lie is their Memory's: get(i), set(i, open).
#pragma once

#include "kernels/config.h"

#include <cstdint>

namespace pt {

template <class Open, std::uint32_t most>
struct LocalMemory {
    Open entries[most];

    PT_HD Open get(std::uint32_t i) const { return entries[i]; }
    PT_HD void set(std::uint32_t i, const Open& open) { entries[i] = open; }
};

// Holds all that can wait. The memory is apart: an array that is indexed at run time keeps its neighbours in memory.
template <class Open, class MemoryT>
class FullStack {
public:
    using Memory = MemoryT;

    PT_HD explicit FullStack(Memory& memory) : memory_(memory) {}

    PT_HD void clear() { size_ = 0; }
    PT_HD void push(const Open& open) { memory_.set(size_++, open); }
    PT_HD bool pop(Open& open) {
        if (size_ == 0) {
            return false;
        }
        open = memory_.get(--size_);
        return true;
    }

    // For nodes of many children, which are put in order where they wait.
    PT_HD std::uint32_t size() const { return size_; }
    PT_HD Open get(std::uint32_t i) const { return memory_.get(i); }
    PT_HD void set(std::uint32_t i, const Open& open) { memory_.set(i, open); }
    PT_HD void grow() { ++size_; }

    // For nodes of two children: which one to enter where both are met, and whether to where one is.
    PT_HD bool enters_nearer(const Open& further) {
        push(further);
        return true;
    }
    PT_HD bool enters_only_child() { return true; }

private:
    Memory& memory_;
    std::uint32_t size_ = 0;
};

// Holds the last few that wait, of a binary tree. Where it has forgotten one, the walk starts again at the root and
// finds its way by the trail: a bit for each level, 1 where all below the nearer child has been visited or the ray
// meets one child alone. Laine, "Restart Trail for Stackless BVH Traversal", HPG 2010. A tree of 64 levels has a bit
// for each inner node on a way, and a carry out of the last says that nothing is left.
template <class Open, class MemoryT, std::uint32_t entries>
class ShortStack {
public:
    using Memory = MemoryT;

    PT_HD explicit ShortStack(Memory& memory) : memory_(memory) {}

    PT_HD void clear() {
        trail_ = level_ = restarted_for_ = 0;
        size_ = top_ = 0;
    }
    PT_HD bool enters_nearer(const Open& further) {
        level_ = level_below();
        if ((trail_ & level_) != 0) {
            return false;
        }
        memory_.set(top_, further);
        top_ = top_ + 1 == entries ? 0 : top_ + 1;
        size_ += size_ == entries ? 0 : 1;
        return true;
    }
    // Not where the walk was to enter the further child and the best hit has come nearer than that since.
    PT_HD bool enters_only_child() {
        const std::uint64_t level = level_below();
        if (level == restarted_for_) {
            return false;
        }
        level_ = level;
        trail_ |= level;
        return true;
    }
    PT_HD bool pop(Open& open) {
        if (level_ == 0) {
            return false;
        }
        trail_ = (trail_ & (0 - level_)) + level_;
        if (trail_ == 0) {
            return false;
        }
        level_ = restarted_for_ = trail_ & (0 - trail_);
        if (size_ == 0) {
            level_ = 0;
            open = Open::root();
        } else {
            --size_;
            top_ = (top_ == 0 ? entries : top_) - 1;
            open = memory_.get(top_);
        }
        return true;
    }

private:
    PT_HD std::uint64_t level_below() const { return level_ == 0 ? std::uint64_t{1} << 63 : level_ >> 1; }

    Memory& memory_;
    std::uint64_t trail_ = 0;
    std::uint64_t level_ = 0;          // of the choice that led to the node at hand; 0: it is the root
    std::uint64_t restarted_for_ = 0;  // of the choice that the last one taken up belongs to
    std::uint32_t size_ = 0, top_ = 0;
};

}  // namespace pt
