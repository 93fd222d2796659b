# shellcheck shell=bash disable=SC2154 # what ./run and its other parts set
# Part of ./run: `./run format`, and what it looks at.

clang_format_major=14 # versions differ in what they call formatted, so the check needs this one
python_folders=(analysis tests/analysis tests/package tools packaging/gpu_tests)

cpp_files() {
    find kernels variants harness stability tests -type f -regextype egrep -regex '.*\.(h|hpp|cpp|cu|cuh|inl)' -print0
}

find_clang_format() {
    local candidate
    for candidate in "$venv/bin/clang-format" "clang-format-$clang_format_major" clang-format; do
        [[ $("$candidate" --version 2>/dev/null) == *"version $clang_format_major."* ]] || continue
        printf '%s\n' "$candidate"
        return
    done
}

run_format() {
    local clang_format
    setup
    clang_format=$(find_clang_format)
    [[ -n $clang_format ]] || die 2 "install with: apt-get install -y clang-format-$clang_format_major"
    cpp_files | xargs -0r "$clang_format" -i
    "$venv/bin/python" -m ruff format --quiet "${python_folders[@]}"
}
