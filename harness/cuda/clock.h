// Measures the clock of the GPU's multiprocessors in MHz; takes a fraction of a millisecond.
#pragma once

namespace pt::cuda {

double measure_clock_mhz();

}  // namespace pt::cuda
