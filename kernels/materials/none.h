// Empty header that kernels/materials.h includes for the unused places of the material list.
#pragma once
