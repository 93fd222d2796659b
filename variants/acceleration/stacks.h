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

    // For nodes whose children wait in one group, in an order that the ray's octant fixes: the child at `position` is
    // entered, `rest` waits. Whether the triangles of the node that is entered have been tested before.
    PT_HD bool enter(std::uint32_t, const Open& rest) {
        if (!rest.empty()) {
            push(rest);
        }
        return false;
    }
    // Leaves of a node's children, which were met, those that have not been entered before.
    PT_HD void narrow(Open&) {}

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

// The same of a tree whose children wait in groups (FullStack::enter), up to 8 of a node, in 64 levels of groups below
// the root. The trail has four bits a level, each in a word of its own: which child was entered last, and whether
// others of its group wait. Of the wide trees of Vaidyanathan, Woop, Benthin, "Wide BVH Traversal with a Short Stack",
// HPG 2019, whose trail counts children in the order of their distances; here the order is the octant's, which no hit
// changes.
template <class Open, class MemoryT, std::uint32_t entries>
class ShortGroupStack {
public:
    using Memory = MemoryT;

    PT_HD explicit ShortGroupStack(Memory& memory) : memory_(memory) {}

    PT_HD void clear() {
        waits_ = level_ = target_ = 0;
        position_[0] = position_[1] = position_[2] = 0;
        size_ = top_ = 0;
    }
    PT_HD bool enter(std::uint32_t position, const Open& rest) {
        const std::uint64_t level = level_;
        level_ = level == 0 ? std::uint64_t{1} << 63 : level >> 1;
        if (level == 0) {
            return target_ != 0;
        }
        // The hit has come nearer than the child that leads back: what waits below it is out of reach.
        if (target_ != 0 && position != position_at(level)) {
            leave_trail(level);
        }
        for (std::uint32_t bit = 0; bit < 3; ++bit) {
            position_[bit] = (position_[bit] & ~level) | ((position >> bit & 1u) != 0 ? level : 0);
        }
        waits_ &= ~level;
        if (!rest.empty()) {
            waits_ |= level;
            memory_.set(top_, rest);
            top_ = top_ + 1 == entries ? 0 : top_ + 1;
            size_ += size_ == entries ? 0 : 1;
        }
        return target_ != 0;
    }
    PT_HD void narrow(Open& met) {
        if (target_ == 0) {
            return;
        }
        const bool is_there = level_ == target_;
        met.keep_up_to(position_at(level_), !is_there);
        if (is_there || met.empty()) {
            leave_trail(level_);
        }
    }
    PT_HD bool pop(Open& open) {
        if (waits_ == 0) {
            return false;
        }
        const std::uint64_t deepest = waits_ & (0 - waits_);
        if (size_ == 0) {
            target_ = deepest;
            level_ = 0;
            open = Open::root();
        } else {
            waits_ &= ~deepest;
            level_ = deepest;
            --size_;
            top_ = (top_ == 0 ? entries : top_) - 1;
            open = memory_.get(top_);
        }
        return true;
    }

private:
    PT_HD std::uint32_t position_at(std::uint64_t level) const {
        return ((position_[0] & level) != 0 ? 1u : 0u) | ((position_[1] & level) != 0 ? 2u : 0u) |
               ((position_[2] & level) != 0 ? 4u : 0u);
    }
    // From here on the walk is where it has not been; nothing waits at this level or below.
    PT_HD void leave_trail(std::uint64_t level) {
        target_ = 0;
        waits_ &= ~(level | (level - 1));
    }

    Memory& memory_;
    // A bit a level, the highest the first below the root.
    std::uint64_t waits_ = 0;
    std::uint64_t position_[3] = {0, 0, 0};
    std::uint64_t level_ = 0;   // of the group in hand; 0: it is the root, or below the last
    std::uint64_t target_ = 0;  // of the group that the walk finds its way back to
    std::uint32_t size_ = 0, top_ = 0;
};

template <class Open, class Memory, std::uint32_t entries, bool in_groups = Open::is_group>
struct ShortStackFor {
    using Type = ShortStack<Open, Memory, entries>;
};
template <class Open, class Memory, std::uint32_t entries>
struct ShortStackFor<Open, Memory, entries, true> {
    using Type = ShortGroupStack<Open, Memory, entries>;
};

}  // namespace pt
