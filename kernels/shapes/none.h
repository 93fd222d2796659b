// Empty header that kernels/shapes.h includes for the unused places of the shape list.
#pragma once
