// What kernels/materials.h includes for the places that its list leaves empty.
#pragma once
