#include "harness/stability/timed_variants.h"

#include "harness/stability/evaluate.h"

namespace pt::stability {

namespace {

std::vector<std::string> timed_integrators(Backend backend, std::size_t turn) {
    std::vector<std::string> integrators, queues;
    for (const Choice* choice : Registry::instance().choices(axes::integrator, backend)) {
        const auto traits = traits_in<IntegratorTraits>(choice->descriptor);
        if (!traits.inspects) {
            (traits.has_queue ? queues : integrators).emplace_back(choice->descriptor.name);
        }
    }
    integrators.push_back(queues.at(turn % queues.size()));
    return integrators;
}

std::vector<std::string> bounded_arithmetics(Backend backend) {
    std::vector<std::string> names;
    for (const Choice* choice : Registry::instance().choices(axes::arithmetic, backend)) {
        if (!traits_in<ArithmeticTraits>(choice->descriptor).is_approximate) {
            names.emplace_back(choice->descriptor.name);
        }
    }
    return names;
}

}  // namespace

std::vector<Variant> timed_variants(Backend backend, std::size_t turn, bool quick) {
    if (backend == Backend::cpu) {
        return {};
    }
    const std::vector<std::string> integrators = timed_integrators(backend, turn);
    const std::vector<std::string> arithmetics = bounded_arithmetics(backend);
    Variant of_scene = plainest_variant(backend);
    of_scene.set(axes::specialisation, Registry::instance().baseline(backend)[axes::specialisation]);
    std::vector<Variant> variants;
    for (std::size_t i = 0; i < integrators.size(); ++i) {
        for (std::size_t a = 0; a < arithmetics.size(); ++a) {
            if (quick && (i + a + turn) % 2 != 0) {
                continue;
            }
            Variant variant = of_scene;
            variant.set(axes::integrator, integrators[i]);
            variant.set(axes::arithmetic, arithmetics[a]);
            // Every second variant is without the planes of a room (tunable room=0). In quick runs i + a + turn is
            // always even, and each queue comes again after as many turns as there are queues. So `turn` is divided
            // before it is added, by 2 and by 4: then each integrator is with a room in some cases and without in
            // others.
            if ((i + a + turn / 2 + turn / 4) % 2 != 0) {
                variant.tuning["room"] = 0;
            }
            variants.push_back(without_foreign_tunables(variant, backend));
        }
    }
    return variants;
}

}  // namespace pt::stability
