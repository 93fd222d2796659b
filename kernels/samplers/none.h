// Empty header that kernels/rng.h includes for the unused places of the sampler list.
#pragma once
