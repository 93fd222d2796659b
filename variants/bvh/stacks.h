// Traversal stacks for traversals in steps (walk.h). A stack's Memory holds its entries: get(i), set(i, open).
#pragma once

#include "kernels/math.h"
#include "variants/bvh/walk.h"

namespace pt {

template <class Open, std::uint32_t most>
struct LocalMemory {
    Open entries[most];

    PT_HD Open get(std::uint32_t i) const { return entries[i]; }
    PT_HD void set(std::uint32_t i, const Open& open) { entries[i] = open; }
};

// A traversal stack with room for every entry that can wait. Its array is a separate object, Memory: an array that is
// indexed at run time would keep the stack's other members in memory, too.
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

    // Pushes the children of a wide node that the ray enters (entries of 0 or more), the nearest on top. Returns
    // whether the walk enters the child `link` directly: never here, where the walk pops the nearest child, too.
    template <class Real, int width>
    PT_HD bool enters_nearest(const Real (&entries)[width], const std::uint32_t (&links)[width], std::uint32_t&) {
        const std::uint32_t bottom = size_;
        for (int child = 0; child < width; ++child) {
            if (entries[child] < Real(0)) {
                continue;
            }
            std::uint32_t at = size_;
            for (; at > bottom && memory_.get(at - 1).entry < entries[child]; --at) {
                memory_.set(at, memory_.get(at - 1));
            }
            memory_.set(at, {entries[child], links[child]});
            ++size_;
        }
        return false;
    }

    // Pushes the further child of a node, both being entered. Returns whether the walk enters the nearer one: always.
    PT_HD bool enters_nearer(const Open& further) {
        push(further);
        return true;
    }
    PT_HD bool enters_only_child() { return true; }

    // Enters the child at `position`, in the order of the ray's octant, and pushes `rest`, the group of the same node's
    // children that wait. Returns whether the triangles of the entered child have been tested before.
    PT_HD bool enter(std::uint32_t, const Open& rest) {
        if (!rest.empty()) {
            push(rest);
        }
        return false;
    }
    // Drops, on the way back after a restart, the children entered before from those that the ray enters.
    PT_HD void narrow(Open&) {}

private:
    Memory& memory_;
    std::uint32_t size_ = 0;
};

// A short stack for binary trees, which holds the last few children that wait. Where it has dropped one, the walk
// restarts at the root and finds its way by the trail: a bit for each level, 1 where all below the nearer child has
// been visited or the ray enters one child alone. Laine, "Restart Trail for Stackless BVH Traversal", HPG 2010. A tree
// of 64 levels has a bit for each inner node on a way, and a carry out of the last bit says that nothing is left.
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
    // Whether to enter the only child that the ray meets: not if the walk restarted for the further child, and the best
    // hit has come nearer than that child.
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
    std::uint64_t level_ = 0;          // level, as a bit of the trail, of the current node's parent; 0 at the root
    std::uint64_t restarted_for_ = 0;  // level, as a bit of the trail, of the last node whose further child was entered
    std::uint32_t size_ = 0, top_ = 0;
};

// A short stack for trees whose children wait in groups (FullStack::enter), up to 8 in a node, in 64 levels of groups
// below the root. Where it has dropped an entry, the walk restarts at the root and follows its trail, four bits a
// level, each in a word of its own: which child was entered last, and whether others of its group wait. Vaidyanathan,
// Woop, Benthin, "Wide BVH Traversal with a Short Stack", HPG 2019, count children in the order of their distances;
// here the order is the octant's, which no hit changes.
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
        // If the trail's child is not among those entered, the best hit is nearer than that child: what waits below is
        // out of reach.
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
    // Leaves the trail of a restart: from here on nodes are new to the walk, and none waits at `level` or below.
    PT_HD void leave_trail(std::uint64_t level) {
        target_ = 0;
        waits_ &= ~(level | (level - 1));
    }

    Memory& memory_;
    // In waits_, position_, level_, target_ each bit stands for a tree level, the highest for that under the root.
    std::uint64_t waits_ = 0;
    std::uint64_t position_[3] = {0, 0, 0};
    std::uint64_t level_ = 0;   // level of the group of children being visited; 0: at the root, or below the last level
    std::uint64_t target_ = 0;  // level down to which a restarted walk follows its trail; 0: it follows none
    std::uint32_t size_ = 0, top_ = 0;
};

// A short stack for trees of up to 8 children a node that are entered by their distances, in at most 32 levels of inner
// nodes. Where it has dropped an entry, the walk restarts at the root and follows its trail. The distance at which a
// ray enters a box does not depend on hits: a nearer hit leaves out the last of a node's children and keeps the order
// of the others, so a child is found again by its place in the order. The trail has for each level the place of the
// child that was entered last, and whether others wait. Vaidyanathan, Woop, Benthin, "Wide BVH Traversal with a Short
// Stack", HPG 2019.
template <class Open, class MemoryT, std::uint32_t entries>
class ShortOrderStack {
public:
    using Memory = MemoryT;

    PT_HD explicit ShortOrderStack(Memory& memory) : memory_(memory) {}

    PT_HD void clear() {
        waits_ = level_ = target_ = 0;
        for (std::uint32_t bit = 0; bit < place_bits; ++bit) {
            place_[bit] = 0;
        }
        size_ = top_ = 0;
    }
    template <class Real, int width>
    PT_HD bool enters_nearest(const Real (&entries_of)[width], const std::uint32_t (&links)[width],
                              std::uint32_t& link) {
        std::uint32_t place[width];
        const std::uint32_t met = put_in_order(entries_of, place);
        level_ = level_ == 0 ? highest_level : level_ >> 1;
        const std::uint32_t first = target_ != 0 ? place_at(level_) : 0;
        if (target_ == level_ || met <= first) {
            target_ = 0;
        }
        waits_ &= ~(level_ | (level_ - 1));
        // If the ray enters no child, or the best hit is nearer than the child on the trail, what waits below is out of
        // reach.
        if (met <= first) {
            return false;
        }
        set_place_at(level_, first);
        const std::uint32_t waiting = met - first - 1;
        waits_ |= waiting != 0 ? level_ : 0;
        for (int child = 0; child < width; ++child) {
            if (place[child] == first) {
                link = links[child];
            }
            const std::uint32_t above = place[child] - first - 1;  // stack entries to lie above that of this child
            if (above < waiting && above < entries) {
                const Real entry = absolute(entries_of[child]);  // clears a zero's sign: pop() takes signs as marks
                memory_.set((top_ + waiting - 1 - above) % entries,
                            {above == waiting - 1 ? -entry : entry, links[child]});
            }
        }
        top_ = (top_ + waiting) % entries;
        size_ = size_ + waiting < entries ? size_ + waiting : entries;
        return true;
    }
    PT_HD bool pop(Open& open) {
        if (waits_ == 0 || target_ != 0) {
            return false;
        }
        const std::uint32_t deepest = waits_ & (0 - waits_);
        step_place_at(deepest);
        if (size_ == 0) {
            target_ = deepest;
            level_ = 0;
            open = Open::root();
            return true;
        }
        level_ = deepest;
        --size_;
        top_ = (top_ == 0 ? entries : top_) - 1;
        open = memory_.get(top_);
        if (bits_of(open.entry) < 0) {
            waits_ &= ~deepest;
            open.entry = -open.entry;
        }
        return true;
    }

private:
    static constexpr std::uint32_t place_bits = Open::width <= 4 ? 2 : 3;
    static constexpr std::uint32_t highest_level = 1u << 31;
    static_assert(Open::width <= 8);

    // Ranks a node's children by entry distance, in FullStack's order where two are equal; those that the ray misses
    // come last. Returns how many the ray enters.
    template <class Real, int width>
    PT_HD static std::uint32_t put_in_order(const Real (&entries_of)[width], std::uint32_t (&place)[width]) {
        std::uint32_t met = 0;
        for (int child = 0; child < width; ++child) {
            met += entries_of[child] < Real(0) ? 0 : 1;
            place[child] = 0;
        }
        for (int later = 1; later < width; ++later) {
            for (int child = 0; child < later; ++child) {
                const bool is_first = entries_of[later] >= Real(0) &&
                                      (entries_of[child] < Real(0) || entries_of[later] <= entries_of[child]);
                place[child] += is_first ? 1 : 0;
                place[later] += is_first ? 0 : 1;
            }
        }
        return met;
    }
    PT_HD std::uint32_t place_at(std::uint32_t level) const {
        std::uint32_t place = 0;
        for (std::uint32_t bit = 0; bit < place_bits; ++bit) {
            place |= (place_[bit] & level) != 0 ? 1u << bit : 0;
        }
        return place;
    }
    PT_HD void set_place_at(std::uint32_t level, std::uint32_t place) {
        for (std::uint32_t bit = 0; bit < place_bits; ++bit) {
            place_[bit] = (place_[bit] & ~level) | ((place >> bit & 1u) != 0 ? level : 0);
        }
    }
    PT_HD void step_place_at(std::uint32_t level) {
        std::uint32_t carry = level;
        for (std::uint32_t bit = 0; bit < place_bits; ++bit) {
            const std::uint32_t before = place_[bit];
            place_[bit] = before ^ carry;
            carry &= before;
        }
    }

    Memory& memory_;
    // Each bit of waits_, place_, level_ and target_ stands for a level of the tree, the highest for the root. A
    // negated distance in a stack entry marks the last waiting child of a node.
    std::uint32_t waits_ = 0;
    std::uint32_t place_[place_bits] = {};
    std::uint32_t level_ = 0;   // level of the current node's parent, as one bit; 0 at the root
    std::uint32_t target_ = 0;  // level down to which a restarted walk follows its trail; 0: it follows none
    std::uint32_t size_ = 0, top_ = 0;
};

template <class Open, class Memory, std::uint32_t entries>
struct ShortStackFor {
    using Type = ShortGroupStack<Open, Memory, entries>;
};
template <class Real, class Memory, std::uint32_t entries, int width>
struct ShortStackFor<OpenLink<Real, width>, Memory, entries> {
    using Type = ShortOrderStack<OpenLink<Real, width>, Memory, entries>;
};
template <class Real, class Memory, std::uint32_t entries>
struct ShortStackFor<OpenLink<Real, 2>, Memory, entries> {
    using Type = ShortStack<OpenLink<Real, 2>, Memory, entries>;
};

}  // namespace pt
