// Macros to include the headers of a list, one for each line of it: kernels/shapes.h, kernels/materials.h. An #include
// takes a macro, but no loop, hence one line for each place of the list.
#pragma once

// PT_PICK_n(...) is the n-th of its arguments, counted from 0.
#define PT_PICK_0(a, ...) a
#define PT_PICK_1(a, b, ...) b
#define PT_PICK_2(a, b, c, ...) c
#define PT_PICK_3(a, b, c, d, ...) d
#define PT_PICK_4(a, b, c, d, e, ...) e
#define PT_PICK_5(a, b, c, d, e, f, ...) f
#define PT_PICK_6(a, b, c, d, e, f, g, ...) g
#define PT_PICK_7(a, b, c, d, e, f, g, h, ...) h
#define PT_PICK_8(a, b, c, d, e, f, g, h, i, ...) i
#define PT_PICK_9(a, b, c, d, e, f, g, h, i, j, ...) j
#define PT_PICK_10(a, b, c, d, e, f, g, h, i, j, k, ...) k
#define PT_PICK_11(a, b, c, d, e, f, g, h, i, j, k, l, ...) l
#define PT_PICK_12(a, b, c, d, e, f, g, h, i, j, k, l, m, ...) m
#define PT_PICK(n, ...) PT_PICK_##n(__VA_ARGS__)

// Fills the unused places of a list, for which kernels/FOLDER/none.h is included.
#define PT_NO_MORE none, none, none, none, none, none, none, none, none, none, none, none, none, none

// Path of the header for the n-th name of a list: kernels/FOLDER/NAME.h.
#define PT_FILE_AT(n, folder, ...) PT_FILE_OF(folder, PT_PICK(n, __VA_ARGS__))
#define PT_FILE_OF(folder, name) PT_FILE_NAMED(folder, name)
#define PT_QUOTED(path) #path
// clang-format off
#define PT_FILE_NAMED(folder, name) PT_QUOTED(kernels/folder/name.h)
// clang-format on
